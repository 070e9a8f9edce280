// SPDX-License-Identifier: Apache-2.0
#include "io/direction_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sateen::io {
namespace {

DirectionPair pair(double tl, double pl, double tv, double pv) {
    return {*direction_key(tl, pl), *direction_key(tv, pv)};
}

void expect_directions(const char* name, const DirectionPair& expected) {
    const NamedDirections named = parse_directions(name);
    ASSERT_EQ(named.kind, NameKind::full) << name << ": " << named.problem;
    EXPECT_EQ(named.directions.light, expected.light) << name;
    EXPECT_EQ(named.directions.view, expected.view) << name;
}

TEST(DirectionNames, AreFoundInEveryKnownNaming) {
    const DirectionPair p = pair(15, 0, 15, 120);
    expect_directions("MANYFILES/tv030_pv090/00084 tl015 pl000 tv015 pv120.jpg", p);
    expect_directions("WoolPKNT256_00084_tl015_pl000_tv015_pv120.jpg", p);
    expect_directions("tl015pl000tv015pv120.png", p);
    expect_directions("img_tv15_pv120_tl15_pl0.jpg", p);
    expect_directions("tv015_pv120/tl015_pl000_tv015_pv120.exr", p);
    expect_directions("pv120 tv015 pl000 tl015.JPG", p);
    expect_directions("TL015_PL000_TV015_PV120.tif", p);
    expect_directions("tl 15 pl 0 tv 15 pv 120.jpg", p);
    expect_directions("tl_15__pl_0__tv_15__pv_120_final.jpg", p);
    expect_directions("castle_plate_tl015_pl000_tv015_pv120.jpg", p);
    expect_directions("tl20.25_pl10_tv11.5_pv0.exr", pair(20.25, 10, 11.5, 0));
    expect_directions("tv11.500000_pv0.000000_tl20.250000_pl10.000000.exr",
                      pair(20.25, 10, 11.5, 0));
    expect_directions("tl20_pl10_tv11_pv0.5", pair(20, 10, 11, 0));
}

TEST(DirectionNames, TakeAnglesFromTheBaseNameOnly) {
    EXPECT_EQ(parse_directions("tl015_pl000_tv030_pv090/image.jpg").kind, NameKind::none);
}

TEST(DirectionNames, WrapAzimuthsAndForgetThemAtThePole) {
    EXPECT_EQ(*direction_key(30, 360), *direction_key(30, 0));
    EXPECT_EQ(*direction_key(30, -90), *direction_key(30, 270));
    EXPECT_EQ(*direction_key(30, 359.99999), *direction_key(30, 0));
    EXPECT_EQ(*direction_key(30, 20.00001), *direction_key(30, 20));
    EXPECT_NE(*direction_key(30, 20.0002), *direction_key(30, 20));
    EXPECT_EQ(*direction_key(0, 123), *direction_key(0, 0));
    expect_directions("tl30_pl-90_tv0_pv77.jpg", pair(30, 270, 0, 0));
    const Direction d = direction_key(45, 180)->direction();
    EXPECT_FLOAT_EQ(d.theta, std::numbers::pi_v<float> / 4);
    EXPECT_FLOAT_EQ(d.phi, std::numbers::pi_v<float>);
}

TEST(DirectionNames, RefuseThetaOutsideTheHemisphere) {
    EXPECT_TRUE(direction_key(90, 0));
    EXPECT_FALSE(direction_key(90.001, 0));
    EXPECT_FALSE(direction_key(-1, 0));
    EXPECT_FALSE(direction_key(std::nan(""), 0));
    EXPECT_FALSE(direction_key(10, std::nan("")));
    EXPECT_FALSE(direction_key(10, 1e300));
}

TEST(DirectionNames, SayWhatIsWrongWithAPartialName) {
    const auto problem = [](const char* name) {
        const NamedDirections named = parse_directions(name);
        EXPECT_EQ(named.kind, NameKind::partial) << name;
        return named.problem;
    };
    EXPECT_THAT(problem("tlXX pl000 tv000 pv000.jpg"),
                testing::HasSubstr("no degrees after 'tl'"));
    EXPECT_THAT(problem("tl0x5 pl000 tv000 pv000.jpg"),
                testing::HasSubstr("expected degrees after 'tl'"));
    EXPECT_THAT(problem("tl015 pl000.jpg"), testing::HasSubstr("after 'tv'"));
    EXPECT_THAT(problem("tl015 pl000 tv095 pv000.jpg"),
                testing::HasSubstr("view: found theta 95, expected 0 to 90"));
    EXPECT_THAT(problem("tl015 tl030 pl000 tv000 pv000.jpg"),
                testing::HasSubstr("'tl' twice"));
}

TEST(DirectionNames, OrdinaryNamesHaveNone) {
    for (const char* name : {"stone.jpg", "castle_1.png", "pl2.jpg", "tv.png", "",
                             "atl15 apl20.jpg", ".jpg", "settlement 12.jpg"})
        EXPECT_EQ(parse_directions(name).kind, NameKind::none) << name;
}

TEST(DirectionsCsv, ReadsRowsInOrder) {
    const auto rows = parse_directions_csv(
        "file,theta_i,phi_i,theta_v,phi_v\na.png,15,0,30,90\nb.png,0,0,0,0\n", "csv");
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 2U);
    EXPECT_EQ((*rows)[0].file, "a.png");
    EXPECT_EQ((*rows)[0].directions.light, *direction_key(15, 0));
    EXPECT_EQ((*rows)[0].directions.view, *direction_key(30, 90));
    EXPECT_EQ((*rows)[1].line, 3U);
}

TEST(DirectionsCsv, TakesWhatSpreadsheetsWrite) {
    const auto rows = parse_directions_csv(
        "\xEF\xBB\xBF# of the robot\r\n\r\nshot, Phi_V ,theta_v,phi_i,theta_i,FILE\r\n"
        "1,90,3.0e1,+5,15.5,\"a, \"\"b\"\".png\"\r\n# comment\r\n  "
        "\r\n2,0,0,0,0,sub/c.png",
        "csv");
    ASSERT_TRUE(rows) << rows.error().message;
    ASSERT_EQ(rows->size(), 2U);
    EXPECT_EQ((*rows)[0].problem, "");
    EXPECT_EQ((*rows)[0].file, "a, \"b\".png");
    EXPECT_EQ((*rows)[0].directions.light, *direction_key(15.5, 5));
    EXPECT_EQ((*rows)[0].directions.view, *direction_key(30, 90));
    EXPECT_EQ((*rows)[1].file, "sub/c.png");
}

TEST(DirectionsCsv, NeedsAHeader) {
    for (const char* text : {"", "\n\n# nothing\n", "a.png,15,0,30,90\n",
                             "file,theta_i,phi_i,theta_v\na.png,15,0,30\n"}) {
        const auto rows = parse_directions_csv(text, "x.csv");
        ASSERT_FALSE(rows) << text;
        EXPECT_THAT(rows.error().message,
                    testing::HasSubstr("file,theta_i,phi_i,theta_v,phi_v"));
    }
}

TEST(DirectionsCsv, RowsStateTheirProblems) {
    const std::string header = "file,theta_i,phi_i,theta_v,phi_v\n";
    const auto problem = [&](const std::string& row) {
        const auto rows = parse_directions_csv(header + row, "csv");
        EXPECT_TRUE(rows && rows->size() == 1);
        return rows ? rows->front().problem : "";
    };
    EXPECT_THAT(problem("a.png,15,x,30,0"), testing::HasSubstr("phi_i: found 'x'"));
    EXPECT_THAT(problem("a.png,15,0,30"), testing::HasSubstr("found 4 fields"));
    EXPECT_THAT(problem("a.png,15,0,91,0"), testing::HasSubstr("theta 91"));
    EXPECT_THAT(problem("a.png,nan,0,9,0"), testing::HasSubstr("theta nan"));
    EXPECT_THAT(problem("\"a.png,15,0,9,0"), testing::HasSubstr("open quote"));
    EXPECT_THAT(problem(",15,0,9,0"), testing::HasSubstr("empty file name"));
    EXPECT_THAT(problem("a.png,15;0,30,0,0"), testing::HasSubstr("found '15;0'"));
}

}  // namespace
}  // namespace sateen::io
