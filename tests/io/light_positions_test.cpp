// SPDX-License-Identifier: Apache-2.0
#include "io/light_positions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files.hpp"
#include "sateen/io/open_measurement.hpp"

namespace sateen {
namespace {

using io::LightPosition;
using io::LightPositions;
using testing::ElementsAre;
using testing::HasSubstr;

LightPositions parsed(std::string_view text) {
    auto result = io::parse_light_positions(text, "a.lp");
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

void expect_light(const LightPosition& light, const char* file, float theta, float phi) {
    EXPECT_EQ(light.problem, "");
    EXPECT_EQ(light.file, file);
    EXPECT_NEAR(static_cast<float>(light.direction.theta) / 1e4F, theta, 1e-3F);
    EXPECT_NEAR(static_cast<float>(light.direction.phi) / 1e4F, phi, 1e-3F);
}

TEST(LightPositions, XIsToTheRightAndYIsUp) {
    const auto file = parsed("3\na.jpg 0 0 1\nb.jpg 1 0 1\nc.jpg\t0\t1\t0\n");
    ASSERT_EQ(file.lights.size(), 3U);
    expect_light(file.lights[0], "a.jpg", 0, 0);
    expect_light(file.lights[1], "b.jpg", 45, 0);
    expect_light(file.lights[2], "c.jpg", 90, 90);
    EXPECT_EQ(file.note, "");
}

TEST(LightPositions, UnderstandsWhatIsFoundInTheWild) {
    const auto file = parsed(
        "\xEF\xBB\xBF\r\n 6 \r\n"
        "C:\\RTI scans\\my icon 01.jpg 0,5 0,5 0,70710678\r\n"
        "\r\n"
        "/home/a b/02.JPG  -12  0  +12\r\n"
        "03.jpg 1 0 -0.000204\r\n");
    ASSERT_EQ(file.lights.size(), 3U);
    expect_light(file.lights[0], "my icon 01.jpg", 45, 45);
    expect_light(file.lights[1], "02.JPG", 45, 180);
    expect_light(file.lights[2], "03.jpg", 90, 0);
    EXPECT_EQ(file.note, "a.lp: states 6 images and lists 3");
    EXPECT_THAT(parsed("a.jpg 0 0 1").note, HasSubstr("does not begin with the number"));
}

TEST(LightPositions, LinesTellTheirProblems) {
    const auto file = parsed(
        "5\na.jpg 0 0\na.jpg 0 0 up\n0 0 1\na.jpg 0 0 0\na.jpg 0 0.5 -0.5\n"
        "a.jpg nan 0 1\n");
    std::vector<std::string> problems;
    for (const LightPosition& light : file.lights) problems.push_back(light.problem);
    EXPECT_THAT(problems,
                ElementsAre(HasSubstr("found 'a.jpg', expected FILE X Y Z"),
                            HasSubstr("found 'up'"), HasSubstr("no file name"),
                            HasSubstr("without length"), HasSubstr("above the horizon"),
                            HasSubstr("found 'nan'")));
}

TEST(LightPositions, RefusesEmptyAndEndlessFiles) {
    EXPECT_FALSE(io::parse_light_positions("", "a.lp"));
    EXPECT_FALSE(io::parse_light_positions("12\n\n", "a.lp"));
    std::string lines;
    for (std::size_t i = 0; i <= io::kMaxLights; ++i) lines += "a 0 0 1\n";
    const auto result = io::parse_light_positions(lines, "a.lp");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::limit_exceeded);
}

Result<std::unique_ptr<Measurement>> open(const std::string& path,
                                          bool skip_bad = false) {
    return open_measurement({&path, 1}, {.skip_bad = skip_bad});
}

class LightPositionFolder : public testing::Test {
  protected:
    LightPositionFolder() {
        for (int i = 0; i < 3; ++i) {
            Image image(3, 4, 6);
            for (float& v : image.values()) v = 0.25F * static_cast<float>(i + 1);
            test::put(folder_.file("light " + std::to_string(i) + ".png"),
                      test::encoded(".png", image, {.bits = 16}));
        }
    }
    void list(const std::string& text) {
        test::put(folder_.file("dirs.lp"), test::FileBytes(text.begin(), text.end()));
    }
    test::TemporaryFolder folder_;
};

TEST_F(LightPositionFolder, IsAMeasurementOfOneView) {
    list("3\nlight 1.png 0 1 1\nlight 0.png 0 0 1\nlight 2.png 1 0 1\n");
    for (const std::string& path : {folder_.file("dirs.lp"), folder_.path()}) {
        const auto measurement = open(path);
        ASSERT_TRUE(measurement) << measurement.error().message;
        const MeasurementInfo& info = (*measurement)->info();
        EXPECT_EQ(info.layout, "lp");
        EXPECT_TRUE(info.radiometry.cosine_included);
        EXPECT_THAT(info.views, ElementsAre(Direction{}));
        ASSERT_EQ(info.lights.size(), 3U);
        EXPECT_NEAR(info.lights[1].phi, 0, 1e-6);
        EXPECT_NEAR(info.lights[2].phi, 90 * kRadiansPerDegree, 1e-6);
        std::vector<std::string> names;
        for (const Observation& observation : info.observations)
            names.push_back(observation.name);
        EXPECT_THAT(names, ElementsAre("light 0.png", "light 2.png", "light 1.png"));
    }
}

TEST_F(LightPositionFolder, NamesOfAnotherCaseOrExtensionAreFoundInOrder) {
    list("3\nLIGHT 0.PNG 0 0 1\nlight 1.PNG 0 1 1\nlight 2.png 1 0 1\n");
    EXPECT_TRUE(open(folder_.file("dirs.lp")));
    list("3\nDSC1.tif 0 0 1\nDSC2.tif 0 1 1\nDSC3.tif 1 0 1\n");
    const auto measurement = open(folder_.file("dirs.lp"));
    ASSERT_TRUE(measurement) << measurement.error().message;
    EXPECT_THAT((*measurement)->info().skipped,
                ElementsAre(HasSubstr("none of its files exists")));
    EXPECT_EQ((*measurement)->info().observations[0].name, "light 0.png");
}

TEST_F(LightPositionFolder, BadLinesAreErrorsOrSkipped) {
    list("4\nlight 0.png 0 0 1\nlight 1.png 0 1 oops\nlight 9.png 0 1 1\n");
    const auto refused = open(folder_.file("dirs.lp"));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("dirs.lp, line 3: found 'oops'"));
    const auto skipped = open(folder_.file("dirs.lp"), true);
    ASSERT_TRUE(skipped) << skipped.error().message;
    EXPECT_THAT((*skipped)->info().skipped,
                ElementsAre(HasSubstr("line 3"), HasSubstr("'light 9.png'"),
                            HasSubstr("states 4 images and lists 3")));
}

}  // namespace
}  // namespace sateen
