#include "baker/transport/ray_scene.hpp"

#include <algorithm>
#include <bit>

#include "baker/transport/samples.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::Transport;
using testing::upright;

TEST(CosineTable, HasNoDirectionInTheHorizonWhereAFlatFaceWouldBlockIt) {
  for (const std::size_t rays : {128u, 256u, 1024u, 4096u})
    for (const float z : cosineTable(rays).z) EXPECT_GT(z, 0.25f / std::sqrt(static_cast<float>(rays)));
}

TEST(LocalFrame, IsARotationAtThePolesToo) {
  for (const glm::dvec3 n :
       {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1e-9, 0, -1)}) {
    const glm::dmat3 frame = localFrame(glm::normalize(n));
    EXPECT_NEAR(glm::determinant(frame), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(frame[0], frame[1]), 0.0, 1e-12);
    EXPECT_EQ(frame[2], glm::normalize(n));
  }
}

TEST(RayScene, BlocksExactlyTheDirectionsUnderARoof) {
  // The scene is half a roof, x > 0, from straight above to the horizon.
  const auto roof = testing::transformed(flipped(grid({0, 0, 0}, 1e5f, 1)),
                                         glm::translate(glm::mat4(1.0f), {5e4f, 1.0f, 0}));
  const Transport t(sceneOf({roof}));
  const SampleOrigin origin{{0, 0, 0}, {0, 1, 0}, 1.0f};
  const DirectionTable table = cosineTable(512);
  std::vector<std::uint16_t> masks(table.packets());
  EXPECT_EQ(t.rays.trace({std::span(&origin, 1), upright(), table}, masks), 512u);
  for (std::size_t r = 0; r < table.size(); ++r) {
    const glm::vec3 d = upright() * glm::vec3(table.x[r], table.y[r], table.z[r]);
    EXPECT_EQ(masks[r / 16] >> (r % 16) & 1, d.x > 0.0f ? 1 : 0) << d.x;
  }
}

// In a plane that is not parallel to an axis, the rounding of vertices and origins puts half of the origins
// behind it. Nothing may block a ray here.
TEST(RayScene, RaysLeaveTheirOwnFacesAtEveryScaleAndFarFromTheOrigin) {
  for (const float scale : {1e-4f, 1.0f, 1e6f}) {
    const glm::mat4 tilted =
        glm::rotate(glm::translate(glm::scale(glm::mat4(1.0f), glm::vec3(scale)), glm::vec3(100, -40, 70)),
                    0.7f, glm::normalize(glm::vec3(0.3f, 0.5f, 0.8f)));
    const Transport t(sceneOf({testing::transformed(grid({0, 0, 0}, 4.0f, 16), tilted)}));
    const DirectionTable table = cosineTable(128);
    std::vector<std::uint16_t> masks(table.packets());
    std::size_t blocked = 0;
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
      const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(t.samples.normals[s]))));
      t.rays.trace({t.samples.originsOf(s), frame, table}, masks);
      for (const std::uint16_t mask : masks) blocked += static_cast<std::size_t>(std::popcount(mask));
    }
    EXPECT_EQ(blocked, 0u) << "scale " << scale << ", " << t.samples.size() << " samples";
  }
}

// Embree asks for denormals to be flushed. What the thread computes afterwards must not be.
TEST(RayScene, FlushesDenormalsOnlyWhileItTraces) {
  const Transport t(sceneOf({grid({0, 1, 0}, 4.0f, 2)}));
  const SampleOrigin origin{{0, 0, 0}, {0, 1, 0}, 1.0f};
  const DirectionTable table = cosineTable(64);
  std::vector<std::uint16_t> masks(table.packets());
  std::vector<RayHit> hits;
  MetShares met;
  FirstHit hit;
  std::uint8_t blocked = 0;
  const RaySegment segment{.origin = {0, 0, 0}, .direction = {0, 1, 0}, .length = 2.0f};
  volatile float small = 1e-38f;
  const auto expectKept = [&](const char* after) { EXPECT_GT(small * 0.01f, 0.0f) << after; };
  t.rays.trace({std::span(&origin, 1), upright(), table}, masks);
  expectKept("trace");
  t.rays.traceHits({std::span(&origin, 1), upright(), table}, false, masks, hits);
  expectKept("traceHits");
  t.rays.meet({std::span(&origin, 1), upright(), table}, std::span(&met, 1));
  expectKept("meet");
  t.rays.occluded(std::span(&segment, 1), std::span(&blocked, 1));
  expectKept("occluded");
  t.rays.firstHits(std::span(&segment, 1), std::span(&hit, 1));
  expectKept("firstHits");
}

TEST(RayScene, BlocksBelowTheGeometricHorizonWithoutTracing) {
  const Transport t(sceneOf({grid({0, -100, 0}, 1.0f, 1)}));
  const glm::vec3 tilted = glm::normalize(glm::vec3(1, 1, 0));
  const SampleOrigin origin{{0, 0, 0}, tilted, 1.0f};
  const DirectionTable table = cosineTable(256);
  std::vector<std::uint16_t> masks(table.packets());
  const std::uint32_t traced = t.rays.trace({std::span(&origin, 1), upright(), table}, masks);
  std::uint32_t above = 0;
  for (std::size_t r = 0; r < table.size(); ++r) {
    const bool is_above = glm::dot(upright() * glm::vec3(table.x[r], table.y[r], table.z[r]), tilted) > 0.0f;
    above += is_above;
    EXPECT_EQ(masks[r / 16] >> (r % 16) & 1, is_above ? 0 : 1);
  }
  EXPECT_EQ(traced, above);
}

TEST(RayScene, SeesBacksOnlyFromInsideASolid) {
  Scene scene = sceneOf({box({0, 0, 0}, {2, 2, 2}, 2)});
  const DirectionTable table = cosineTable(64);
  const SampleOrigin inside{{0, 0, 0}, {0, 1, 0}, 1.0f}, outside{{0, 1.001f, 0}, {0, 1, 0}, 1.0f};
  MetShares met;
  {
    const Transport t(scene);
    t.rays.meet({std::span(&inside, 1), upright(), table}, std::span(&met, 1));
    EXPECT_EQ(met.back, 1.0f);
    t.rays.meet({std::span(&outside, 1), upright(), table}, std::span(&met, 1));
    EXPECT_EQ(met.back, 0.0f);
  }
  scene.materials[0].double_sided = true;  // then there is no back
  const Transport t(scene);
  t.rays.meet({std::span(&inside, 1), upright(), table}, std::span(&met, 1));
  EXPECT_EQ(met.back, 0.0f);
}

TEST(RayScene, TellsWhatBlockedRaysMetInBothWaysAlike) {
  // A double-sided card is over a single-sided floor that is seen from behind.
  Scene scene = sceneOf({grid({0, 1, 0}, 2.0f, 3), grid({0, 3, 0}, 9.0f, 1)});
  testing::ownMaterial(scene, 0).double_sided = true;
  const Transport t(scene);
  const SampleOrigin origin{{0.1f, 0, 0.2f}, {0, 1, 0}, 1.0f};
  const DirectionTable table = cosineTable(1024);
  std::vector<std::uint16_t> masks(table.packets()), asked_first(masks), at_once(masks);
  std::vector<RayHit> hits, hits_at_once;
  t.rays.trace({std::span(&origin, 1), upright(), table}, masks);
  t.rays.traceHits({std::span(&origin, 1), upright(), table}, /*mostly_blocked=*/false, asked_first, hits);
  t.rays.traceHits({std::span(&origin, 1), upright(), table}, /*mostly_blocked=*/true, at_once, hits_at_once);
  EXPECT_EQ(asked_first, masks);
  EXPECT_EQ(at_once, masks);
  ASSERT_EQ(hits.size(), hits_at_once.size());
  EXPECT_GT(hits.size(), 100u);
  const DrawGeometry& back = t.geometry.draws[1];
  ASSERT_TRUE(back.back);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_EQ(hits[i].triangle, hits_at_once[i].triangle);
    // Only the card is listed, by its back, where the ray crosses it: the floor above shows its own back.
    ASSERT_GE(hits[i].triangle, back.first_triangle);
    ASSERT_LT(hits[i].triangle, back.first_triangle + back.triangle_count);
    const glm::uvec3 corners = t.geometry.triangles[hits[i].triangle];
    const glm::vec3 place = (1.0f - hits[i].u - hits[i].v) * t.geometry.positions[corners.x] +
                            hits[i].u * t.geometry.positions[corners.y] +
                            hits[i].v * t.geometry.positions[corners.z];
    const std::size_t r = hits[i].ray;
    const glm::vec3 d = upright() * glm::vec3(table.x[r], table.y[r], table.z[r]);
    EXPECT_LT(glm::distance(place, origin.position + d / d.y), 1e-4f);
  }
}

TEST(RayScene, SegmentsEndWhereTheyEnd) {
  const Transport t(sceneOf({grid({0, 1, 0}, 2.0f, 1)}));
  const std::vector<RaySegment> segments = {
      {{0, 0, 0}, {0, 1, 0}, 0.9f}, {{0, 0, 0}, {0, 1, 0}, 1.1f}, {{5, 0, 0}, {0, 1, 0}, 9.0f}};
  std::vector<std::uint8_t> blocked(3, 7);
  t.rays.occluded(segments, blocked);
  EXPECT_EQ(blocked, (std::vector<std::uint8_t>{0, 1, 0}));
}

}  // namespace
}  // namespace lambent::baker
