// Lights of the command line: their text, and what they are then.
#include "common/error.h"
#include "tools/rt-trace/parse_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace rt {
namespace {

TEST(ParseLight, APointNeedsNoName) {
    for (const char* const text : {"1,2,3", "point:1,2,3"}) {
        const LightRequest light = parseLight(text);
        EXPECT_EQ(light.position, glm::dvec3(1, 2, 3));
        EXPECT_EQ(light.shape.kind.x, kLightPoint);
        EXPECT_FALSE(light.intensity);
    }
    EXPECT_EQ(parseLight("1,2,3,4,5,6").intensity, glm::vec3(4, 5, 6));
    EXPECT_EQ(parseLight("point:1,2,3,4,5,6").intensity, glm::vec3(4, 5, 6));
}

TEST(ParseLight, DirectionsAreOfUnitLength) {
    const LightRequest sun = parseLight("directional:0,-3,4,1,2,3");
    EXPECT_EQ(sun.shape.kind.x, kLightDirectional);
    EXPECT_EQ(sun.shape.direction, glm::vec4(0, -0.6f, 0.8f, 0));
    EXPECT_EQ(sun.intensity, glm::vec3(1, 2, 3));
    const LightRequest spot = parseLight("spot:1,5,2,1,1,2,60,0");
    EXPECT_EQ(spot.position, glm::dvec3(1, 5, 2));
    EXPECT_EQ(glm::vec3(spot.shape.direction), glm::vec3(0, -1, 0));
    EXPECT_NEAR(spot.shape.direction.w, 0.5f, 1e-6f);
    EXPECT_EQ(spot.shape.edgeU.w, 1.0f);
}

TEST(ParseLight, RectanglesFaceTheirTargetAndAreLevel) {
    const LightRequest lamp = parseLight("rectangle:0,2,5,0,2,0,3,0.5,7,7,7");
    EXPECT_EQ(lamp.shape.kind.x, kLightRectangle);
    EXPECT_EQ(glm::vec3(lamp.shape.direction), glm::vec3(0, 0, -1));
    EXPECT_EQ(glm::abs(glm::vec3(lamp.shape.edgeU)), glm::vec3(1.5f, 0, 0));
    EXPECT_EQ(glm::abs(glm::vec3(lamp.shape.edgeV)), glm::vec3(0, 0.25f, 0));
    const LightRequest ceiling = parseLight("rectangle:0,2,0,0,0,0,1,1");
    EXPECT_EQ(glm::vec3(ceiling.shape.direction), glm::vec3(0, -1, 0));
    EXPECT_EQ(glm::length(glm::vec3(ceiling.shape.edgeU)), 0.5f);
    EXPECT_EQ(parseLight("sphere:1,2,3,0.25").shape.position.w, 0.25f);
}

// What is valid in a file is what shaders take.
TEST(ParseLight, WhatItGivesIsValid) {
    for (const char* const text :
         {"1,2,3", "directional:1,1e-30,0", "spot:0,0,0,1,0,0,90,90", "spot:0,0,0,0,9,0,10,0",
          "rectangle:0,0,0,1e9,1,1,1e-3,9", "sphere:0,0,0,1e-9"}) {
        const LightRequest request = parseLight(text);
        Light light = request.shape;
        light.position = glm::vec4(glm::vec3(request.position), light.position.w);
        EXPECT_TRUE(isValid(light)) << text;
    }
}

TEST(ParseLight, OtherTextIsAUsageError) {
    const std::pair<const char*, const char*> texts[] = {
        {"1,2", "3 numbers, or 6 with R,G,B, not 2"},
        {"1,2,3,4", "not 4"},
        {"1,2,3,4,5,-6", "not negative"},
        {"lamp:1,2,3", "'lamp' is none of"},
        {"directional:0,0,0", "no direction"},
        {"spot:0,0,0,0,0,0,30,10", "no direction"},
        {"spot:0,0,0,1,0,0,30,40", "INNER <= OUTER"},
        {"spot:0,0,0,1,0,0,0,0", "INNER <= OUTER"},
        {"rectangle:0,0,0,1,0,0,0,1", "above 0"},
        {"rectangle:0,0,0,1,0,0,1", "8 numbers"},
        {"sphere:0,0,0,0", "above 0"},
        {"sphere:0,0,0", "4 numbers"},
        {"sphere:0,0,0,nan", "--light"},
    };
    for (const auto& [text, message] : texts) {
        try {
            parseLight(text);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::Usage) << text;
            EXPECT_THAT(error.what(), testing::HasSubstr(message));
        }
    }
}

} // namespace
} // namespace rt
