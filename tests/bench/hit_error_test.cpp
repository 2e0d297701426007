#include "tests/bench/hit_error.h"

#include "common/binary_io.h"
#include "common/error.h"
#include "formats/mesh_file.h"
#include "tests/support/make_mesh.h"
#include "tests/support/run_command.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>

namespace rt::bench {
namespace {

constexpr QueryHitDouble kMissDouble{-1.0, 0.0, 0.0, kNoTriangle, 0};

// Two triangles in the plane z = 0 with a common hypotenuse; the bounds' diagonal is 5.
Mesh makeRectangle() {
    Mesh mesh = test::makeTriangles({{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {3, 4, 0}, {0, 4, 0}, {3, 0, 0}});
    std::vector<glm::vec3> normals(mesh.normals.begin(), mesh.normals.end());
    normals[1] = {1, 0, 0}; // the others are +z
    mesh.normals = SharedSpan<glm::vec3>(std::move(normals));
    return mesh;
}

HitErrors errorsOf(const QueryHitDouble& reference, const QueryHitDouble& got) {
    return measureErrors(makeRectangle(), {&reference, 1}, {&got, 1});
}

TEST(HitError, SpreadIsOfValuesThatWereMeasured) {
    std::vector<double> values;
    for (int i = 1000; i > 0; --i) values.push_back(i);
    ErrorSpread spread = spreadOf(values);
    EXPECT_EQ(spread.median, 500.0);
    EXPECT_EQ(spread.p999, 999.0);
    EXPECT_EQ(spread.max, 1000.0);
    values.push_back(2000.0);
    spread = spreadOf(values);
    EXPECT_EQ(spread.median, 501.0);
    EXPECT_EQ(spread.p999, 1000.0);
    EXPECT_EQ(spread.max, 2000.0);
    EXPECT_TRUE(std::isnan(spreadOf({}).median) && std::isnan(spreadOf({}).max));
}

TEST(HitError, SameHitHasNoError) {
    const QueryHitDouble hit{2.0, 0.25, 0.25, 0, 0};
    const HitErrors errors = errorsOf(hit, hit);
    EXPECT_EQ(errors.compared, 1u);
    for (const double error : {errors.t.max, errors.position.max, errors.normal.max}) EXPECT_EQ(error, 0.0);
}

TEST(HitError, DistanceIsRelative) {
    const HitErrors errors = errorsOf({2.0, 0.25, 0.25, 0, 0}, {2.5, 0.25, 0.25, 0, 0});
    EXPECT_DOUBLE_EQ(errors.t.median, 0.25);
    EXPECT_EQ(errors.position.max, 0.0);
    const HitErrors atStart = errorsOf({0.0, 0.25, 0.25, 0, 0}, {0.0, 0.25, 0.25, 0, 0});
    EXPECT_EQ(atStart.t.max, 0.0) << "not 0 / 0";
}

TEST(HitError, PositionIsInDiagonalsAndNormalInRadians) {
    // From the first corner to the middle of the edge to (3, 0, 0): 1.5 of a diagonal of 5, and from +z half
    // way to +x.
    const HitErrors errors = errorsOf({2.0, 0.0, 0.0, 0, 0}, {2.0, 0.5, 0.0, 0, 0});
    EXPECT_DOUBLE_EQ(errors.position.max, 0.3);
    EXPECT_NEAR(errors.normal.max, std::numbers::pi / 4, 1e-15);
    // Small angles are not lost: between the two corners the normal is (u, 0, 1 - u).
    EXPECT_NEAR(errorsOf({2.0, 0.0, 0.0, 0, 0}, {2.0, 1e-12, 0.0, 0, 0}).normal.max, 1e-12, 1e-17);
}

TEST(HitError, OnlyHitsOfTheSameTriangleAreCompared) {
    const std::vector<QueryHitDouble> reference = {
        kMissDouble, {2.0, 0.5, 0.5, 0, 0}, {2.0, 0.5, 0.5, 0, 0}, {4.0, 0.5, 0.5, 1, 0}};
    const std::vector<QueryHitDouble> got = {
        {2.0, 0.5, 0.5, 0, 0}, kMissDouble, {2.0, 0.5, 0.5, 1, 0}, {4.0, 0.5, std::nan(""), 1, 0}};
    const HitErrors errors = measureErrors(makeRectangle(), reference, got);
    EXPECT_EQ(errors.compared, 0u);
    EXPECT_TRUE(std::isnan(errors.t.max));
}

TEST(HitError, ATriangleThatIsNotThereIsAnError) {
    const QueryHitDouble hit{2.0, 0.25, 0.25, 2, 0};
    EXPECT_THROW(errorsOf(hit, hit), Error);
}

TEST(HitError, FaultsAreToldApart) {
    // Down onto the rectangle, far from its outline: at the middle of the first triangle, and at the common
    // edge.
    const QueryRay inside{{0.5f, 0.5f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}};
    const QueryRay edge{{1.5f, 2.0f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}};
    const QueryHitDouble hit{2.0, 0.5 / 3, 0.125, 0, 0}, atEdge{2.0, 0.5, 0.5, 0, 0};
    const std::vector<QueryRay> rays = {inside, inside, inside, inside, edge};
    const std::vector<QueryHitDouble> reference = {hit, hit, hit, hit, atEdge};
    const std::vector<QueryHitDouble> got = {
        hit, kMissDouble, {1.0, 0.0, 0.0, 1, 0}, {1.0, 0.0, 0.0, 0, 0}, {2.0, 0.5, 0.5, 1, 0}};
    const HitFaults faults = findFaults(makeRectangle(), rays, reference, got);
    EXPECT_EQ(faults.counts.hits, 5u);
    EXPECT_EQ(faults.counts[HitClass::Agree], 1u);
    EXPECT_EQ(faults.counts[HitClass::Lost], 1u);
    EXPECT_EQ(faults.counts[HitClass::Wrong], 2u);
    EXPECT_EQ(faults.counts[HitClass::Tie], 1u);
    EXPECT_EQ(faults.wrongTriangles, 1u);
}

TEST(HitError, AHitThatIsNotFiniteIsNotComparedButWrong) {
    const QueryRay ray{{0.5f, 0.5f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}};
    const QueryHitDouble hit{2.0, 0.5 / 3, 0.125, 0, 0};
    const double nan = std::nan("");
    for (const QueryHitDouble& bad :
         {QueryHitDouble{nan, 0.5, 0.5, 0, 0}, {2.0, nan, 0.125, 0, 0}, {2.0, 0.5 / 3, nan, 0, 0}}) {
        EXPECT_EQ(errorsOf(hit, bad).compared, 0u);
        const HitFaults faults = findFaults(makeRectangle(), {&ray, 1}, {&hit, 1}, {&bad, 1});
        EXPECT_EQ(faults.counts[HitClass::Wrong], 1u) << bad.t << ", " << bad.u << ", " << bad.v;
        EXPECT_EQ(faults.wrongTriangles, 0u);
    }
}

TEST(HitError, RecordsOfBothWidthsSayTheSame) {
    const QueryHitDouble wide{2.5, 0.25, 0.125, 7, 0};
    const QueryHitDouble back = widened(narrowed(wide));
    EXPECT_EQ(back.t, 2.5);
    EXPECT_EQ(back.u, 0.25);
    EXPECT_EQ(back.v, 0.125);
    EXPECT_EQ(back.triangle, 7u);
}

// One ray down onto the rectangle, and its hit in either width.
class MeasureHits : public testing::Test {
protected:
    MeasureHits() {
        const QueryRay ray{{0.5f, 0.5f, 2.0f, 0.0f}, {0.0f, 0.0f, -1.0f, 1e30f}};
        const QueryHitDouble wide{2.0, 0.5 / 3, 0.125, 0, 0};
        const QueryHit narrow = narrowed(wide);
        writeMesh(folder_.file("scene.rtmesh"), makeRectangle());
        writeFile(folder_.file("x.rays"), std::as_bytes(std::span(&ray, 1)));
        writeFile(folder_.file("wide.hits"), std::as_bytes(std::span(&wide, 1)));
        writeFile(folder_.file("narrow.hits"), std::as_bytes(std::span(&narrow, 1)));
    }
    test::CommandResult run(const std::string& reference, const std::string& got) const {
        return test::runCommand({RT_BIN_DIR "/rt_measure_hits", folder_.file(reference), folder_.file(got),
                                 "--rays", folder_.file("x.rays"), "--mesh", folder_.file("scene.rtmesh")});
    }

    const test::TemporaryFolder folder_;
};

TEST_F(MeasureHits, HitsOfBothWidthsAreJudged) {
    for (const char* got : {"narrow.hits", "wide.hits"}) {
        const test::CommandResult result = run("wide.hits", got);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        EXPECT_THAT(result.out, testing::HasSubstr("\"compared\": 1")) << got;
    }
}

TEST_F(MeasureHits, AReferenceInSinglePrecisionIsRefused) {
    const test::CommandResult result = run("narrow.hits", "narrow.hits");
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_EQ(result.out, "");
    for (const char* part : {"narrow.hits: 16 bytes", "64-bit", "1 rays", "--precision double"})
        EXPECT_THAT(result.err, testing::HasSubstr(part));
}

} // namespace
} // namespace rt::bench
