// SPDX-License-Identifier: Apache-2.0
#include "sateen/io/measurement_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "io/files.hpp"
#include "sateen/io/open_measurement.hpp"

namespace sateen {
namespace {

using test::bytes_of;
using test::put;
using test::TemporaryFolder;

/// Grey of a value that tells view and light.
Image image_for(std::size_t view, std::size_t light) {
    Image image(3, 4, 6);
    for (float& v : image.values())
        v = 0.1F + 0.2F * static_cast<float>(view) + 0.05F * static_cast<float>(light);
    return image;
}

DirectionPlan small_plan(float step_deg = 30) {
    return DirectionPlan::product(
        {{}, direction_from_degrees(step_deg, 0)},
        {{}, direction_from_degrees(step_deg, 90), direction_from_degrees(60, step_deg)});
}

MeasurementFormat float_format() {
    MeasurementFormat format;
    format.extension = "exr";
    format.options.bits = 32;
    return format;
}

MeasurementWriter writer_for(const std::string& path, const DirectionPlan& plan,
                             bool resume = false, const std::string& manifest = "{}\n") {
    auto made = MeasurementWriter::create(path, plan, float_format(), manifest, resume);
    if (!made) {
        ADD_FAILURE() << made.error().message;
        std::abort();
    }
    return std::move(*made);
}

void write_all(MeasurementWriter& writer) {
    for (std::size_t view = 0; view < writer.plan().views.size(); ++view)
        for (const std::size_t light : writer.plan().lights_of_view[view])
            ASSERT_TRUE(writer.add(view, light, image_for(view, light)));
    Progress progress;
    const auto finished = writer.finish(progress);
    ASSERT_TRUE(finished) << finished.error().message;
}

void expect_measurement(const std::string& path, const DirectionPlan& plan,
                        const std::string& layout) {
    const auto opened = open_measurement({&path, 1});
    ASSERT_TRUE(opened) << opened.error().message;
    const MeasurementInfo& info = (*opened)->info();
    EXPECT_EQ(info.layout, layout);
    EXPECT_EQ(info.observations.size(), plan.pairs());
    for (std::size_t k = 0; k < info.observations.size(); ++k) {
        const auto& which = info.observations[k];
        const auto index = [](const std::vector<Direction>& list, Direction d) {
            std::size_t best = 0;
            for (std::size_t i = 0; i < list.size(); ++i)
                if (std::abs(list[i].theta - d.theta) + std::abs(list[i].phi - d.phi) <
                    1e-4F)
                    best = i;
            return best;
        };
        const auto image = (*opened)->read(k);
        ASSERT_TRUE(image);
        EXPECT_FLOAT_EQ((*image)(1, 2, 3),
                        image_for(index(plan.views, info.views[which.view]),
                                  index(plan.lights, info.lights[which.light]))(1, 2, 3));
    }
}

TEST(MeasurementWriter, WhatItWritesIsReadBack) {
    const TemporaryFolder folder;
    for (const float step : {30.0F, 22.5F})
        for (const char* name : {"felt.zip", "felt"}) {
            SCOPED_TRACE(name);
            const std::string path = folder.file(std::to_string(step) + "/" + name);
            const DirectionPlan plan = small_plan(step);
            MeasurementWriter writer = writer_for(path, plan);
            write_all(writer);
            expect_measurement(path, plan, step == 30 ? "ubo2003" : "directions.csv");
            EXPECT_FALSE(std::filesystem::exists(writer.partial_path()));
        }
}

TEST(MeasurementWriter, NamesAreThoseOfUbo2003) {
    const TemporaryFolder folder;
    const std::string path = folder.file("felt");
    MeasurementWriter writer = writer_for(path, small_plan());
    write_all(writer);
    EXPECT_TRUE(
        std::filesystem::exists(path + "/tv030_pv000/00005 tl060 pl030 tv030 pv000.exr"));
    EXPECT_TRUE(std::filesystem::exists(path + "/measurement.json"));
}

TEST(MeasurementWriter, ZipsOfEqualImagesAreEqual) {
    const TemporaryFolder folder;
    std::vector<test::FileBytes> zips;
    for (const char* name : {"a/felt.zip", "b/felt.zip"}) {
        const std::string path = folder.file(name);
        MeasurementWriter writer = writer_for(path, small_plan());
        write_all(writer);
        zips.push_back(bytes_of(path));
    }
    EXPECT_EQ(zips[0], zips[1]);
}

TEST(MeasurementWriter, GoesOnWhereAnEarlierOneEnded) {
    const TemporaryFolder folder;
    const std::string path = folder.file("felt.zip");
    const DirectionPlan plan = small_plan();
    {
        const MeasurementWriter first = writer_for(path, plan);
        ASSERT_TRUE(first.add(0, 2, image_for(0, 2)));
        put(first.partial_path() + "/tv000_pv000/.half.exr.tmp-1", std::string("half"));
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    MeasurementWriter second = writer_for(path, plan, true);
    EXPECT_TRUE(second.has(0, 2));
    EXPECT_FALSE(second.has(1, 2));
    write_all(second);
    expect_measurement(path, plan, "ubo2003");

    const MeasurementWriter anew = writer_for(path, plan);
    ASSERT_TRUE(anew.add(0, 2, image_for(0, 2)));
    EXPECT_FALSE(writer_for(path, plan).has(0, 2));
}

TEST(MeasurementWriter, OtherOptionsCannotGoOn) {
    const TemporaryFolder folder;
    const std::string path = folder.file("felt.zip");
    (void)writer_for(path, small_plan());
    const auto other = MeasurementWriter::create(path, small_plan(), float_format(),
                                                 "{\"seed\": 1}\n", true);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, testing::HasSubstr("other options"));
}

TEST(MeasurementWriter, NothingOfAnotherKindIsReplaced) {
    const TemporaryFolder folder;
    put(folder.file("full/file"), std::string("x"));
    put(folder.file("is_folder.zip/file"), std::string("x"));
    for (const char* name : {"full", "is_folder.zip"})
        EXPECT_FALSE(MeasurementWriter::create(folder.path() + "/" + name, small_plan(),
                                               float_format(), "{}", false));
    std::filesystem::create_directories(folder.path() + "/empty");
    MeasurementWriter writer = writer_for(folder.path() + "/empty/", small_plan());
    write_all(writer);
    expect_measurement(folder.path() + "/empty", small_plan(), "ubo2003");
}

TEST(DirectionPlan, AListOfPairsKeepsItsPairs) {
    const TemporaryFolder folder;
    const std::string text =
        "# pairs\ntheta_i,phi_i,theta_v,phi_v\n30,0,0,0\n60,10,15,0\n30,0,15,0\n";
    put(folder.file("list.csv"), text);
    const auto plan = read_direction_plan(folder.file("list.csv"));
    ASSERT_TRUE(plan) << plan.error().message;
    EXPECT_EQ(plan->views.size(), 2U);
    EXPECT_EQ(plan->lights.size(), 2U);
    EXPECT_THAT(plan->lights_of_view[0], testing::ElementsAre(0U));
    EXPECT_THAT(plan->lights_of_view[1], testing::ElementsAre(0U, 1U));
}

TEST(DirectionPlan, AListOfDirectionsMakesAllPairs) {
    const TemporaryFolder folder;
    const std::string text = "phi,theta\n0,0\n90,30\n0,45\n";
    put(folder.file("list.csv"), text);
    const auto plan = read_direction_plan(folder.file("list.csv"));
    ASSERT_TRUE(plan) << plan.error().message;
    EXPECT_EQ(plan->pairs(), 9U);
    EXPECT_NEAR(plan->views[1].phi, 90 * kRadiansPerDegree, 1e-6F);
}

TEST(DirectionPlan, MistakesAreNamedWithTheirLine) {
    const TemporaryFolder folder;
    const auto message = [&](const std::string& text) {
        put(folder.file("list.csv"), text);
        const auto plan = read_direction_plan(folder.file("list.csv"));
        return plan ? std::string() : plan.error().message;
    };
    EXPECT_THAT(message("theta,phi\n0,0\n95,0\n"), testing::HasSubstr("line 3"));
    EXPECT_THAT(message("theta,phi\n0,0\n0,90\n"), testing::HasSubstr("second time"));
    EXPECT_THAT(message("theta,azimuth\n0,0\n"), testing::HasSubstr("no column 'phi'"));
    EXPECT_THAT(message("theta,phi\n"), testing::HasSubstr("no direction"));
    EXPECT_THAT(message(""), testing::HasSubstr("is empty"));
    EXPECT_THAT(message("theta_i,phi_i,theta_v,phi_v\n1,2,x,4\n"),
                testing::HasSubstr("theta_v: found 'x'"));
}

}  // namespace
}  // namespace sateen
