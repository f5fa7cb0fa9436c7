// Compares direct transfer with closed forms (numbers from the literature's tables, signs without
// Condon-Shortley).
#include "baker/effects/surface/direct.hpp"

#include <algorithm>
#include <tuple>

#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::joined;
using testing::largestDifference;
using testing::sceneOf;
using testing::soup;
using testing::transformed;
using testing::Transport;
using testing::turned;
using testing::uniformRadiance;

std::vector<float> open(int order, glm::vec3 normal) {
  std::vector<float> out(static_cast<std::size_t>(sh::coefficientCount(order)));
  sh::unoccludedTransfer(order, normal, out);
  return out;
}

TEST(DirectTransfer, IsUnoccludedOnAnOpenPlaneAtEveryScaleAndPlace) {
  for (const float scale : {1e-3f, 1.0f, 1e4f})
    for (const float away : {0.0f, 1e4f}) {
      // At 1e4 scales away a cell of a millimetre is a few float steps wide: the plane itself is no longer
      // there.
      if (scale < 1.0f && away > 0.0f) continue;
      const Transport t(sceneOf({transformed(grid(glm::vec3(away * 0.01f), 1.0f, 8),
                                             glm::scale(glm::mat4(1.0f), glm::vec3(scale)))}));
      const auto field = t.direct(8);
      for (std::size_t s = 0; s < t.samples.size(); ++s)
        EXPECT_LT(largestDifference(field.at(s), open(8, {0, 1, 0})), 1e-5f) << "scale " << scale;
    }
}

TEST(DirectTransfer, IsUnoccludedToOnePercentOnAConvexBody) {
  const Transport t(sceneOf({icosphere({0, 0, 0}, 2.0f, 2)}));
  const auto field = t.direct();
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    // Only what the facets cut off the smooth normal's hemisphere is missing.
    EXPECT_NEAR(uniformRadiance(field.at(s)), 1.0f, 0.01f);
    EXPECT_LT(largestDifference(field.at(s), open(5, t.samples.normals[s])), 0.01f);
  }
}

// These are the zonal coefficients of a point under a sphere on its normal, before 1/pi (literature 7.2).
TEST(DirectTransfer, UnderASphereMatchesTheClosedForm) {
  struct Row {
    float ratio;
    float m[5];
  };
  for (const Row& row : {Row{0.25f, {.830838f, .928905f, .377368f, -.133024f, -.251929f}},
                         Row{0.50f, {.664670f, .664670f, .092890f, -.380738f, -.420612f}},
                         Row{0.80f, {.319042f, .221039f, -.164082f, -.324136f, -.106241f}}}) {
    // The point looks along +Y; z of the tables is our y, so the zonal part is read off after a rotation.
    const Transport t(sceneOf({grid({0, 0, 0}, 0.01f, 2), icosphere({0, 10.0f, 0}, 10.0f * row.ratio, 5)}));
    const auto field = t.direct(5, 4096);
    const sh::Rotation up_to_z(
        glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(90.0), glm::dvec3(1, 0, 0))), 5);
    std::vector<float> local(25);
    up_to_z.apply(field.at(t.sampleAt({0, 0, 0})), local);
    for (int l = 0; l < 5; ++l)
      EXPECT_NEAR(local[static_cast<std::size_t>(sh::coefficientIndex(l, 0))] * std::numbers::pi_v<float>,
                  row.m[l], 4e-3f)
          << "R/d " << row.ratio << " l " << l;
  }
}

TEST(DirectTransfer, OfASphereOffTheNormalLeavesOneMinusTheCosine) {
  for (const float degrees : {20.0f, 40.0f}) {
    const float a = glm::radians(degrees), distance = 4.0f, radius = 1.0f;
    const glm::vec3 centre = distance * glm::vec3(std::sin(a), std::cos(a), 0.0f);
    const Transport t(sceneOf({grid({0, 0, 0}, 0.01f, 2), icosphere(centre, radius, 5)}));
    const float expected = 1.0f - radius * radius / (distance * distance) * std::cos(a);
    EXPECT_NEAR(uniformRadiance(t.direct(5, 4096).at(t.sampleAt({0, 0, 0}))), expected, 1e-3f);
  }
}

// An infinite wall blocks x < 0, seen from its foot with normal +Z (literature 7.2, before 1/pi).
TEST(DirectTransfer, BesideAnInfiniteWallMatchesTheHalfPlane) {
  const auto wall = turned(grid({0, 0, 0}, 2000.0f, 2), 90.0f, {0, 0, 1});  // in the yz plane
  const auto point = transformed(turned(grid({0, 0, 0}, 1e-3f, 2), 90.0f, {1, 0, 0}),
                                 glm::translate(glm::mat4(1.0f), {1e-2f, 0, 0}));
  const Transport t(sceneOf({wall, point}));
  const auto field = t.direct(5, 4096);
  const std::size_t sample = t.sampleAt({1e-2f, 0, 0});
  ASSERT_NEAR(t.samples.normals[sample].z, 1.0f, 1e-6f);
  struct Value {
    int l, m;
    float value;
  };
  // The table has Condon-Shortley signs; ours differ by (-1)^m.
  std::vector<float> expected(25, 0.0f);
  for (const Value& v : {Value{0, 0, .443113463f}, Value{1, 0, .511663354f}, Value{1, 1, -.325735651f},
                         Value{2, 0, .247707956f}, Value{2, 1, -.429044203f}, Value{3, 1, -.304699606f},
                         Value{3, 3, .078672479f}, Value{4, 0, -.055389183f}, Value{4, 1, -.131370506f},
                         Value{4, 3, .115854788f}})
    expected[static_cast<std::size_t>(sh::coefficientIndex(v.l, v.m))] =
        (v.m % 2 ? -1.0f : 1.0f) * v.value / std::numbers::pi_v<float>;
  EXPECT_LT(largestDifference(field.at(sample), expected), 3e-3f);
}

TEST(DirectTransfer, AtARightAngledCornerIsHalf) {
  // Floor and wall meet at x = 0, each with its own flat normals, so the samples on the edge see a quarter
  // sphere.
  const auto floor =
      transformed(grid({0, 0, 0}, 200.0f, 20), glm::translate(glm::mat4(1.0f), {100.0f, 0, 0}));
  const auto wall = transformed(turned(grid({0, 0, 0}, 200.0f, 20), -90.0f, {0, 0, 1}),
                                glm::translate(glm::mat4(1.0f), {0, 100.0f, 0}));
  const Transport t(sceneOf({floor, wall}));
  const auto field = t.direct();
  int seen = 0;
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    const glm::vec3 p = t.samples.positions[s];
    if (std::abs(p.x) > 1e-3f || std::abs(p.y) > 1e-3f || std::abs(p.z) > 50.0f) continue;
    // The walls end 150 m or more away, from origins 0.1 m off the edge; ray noise is what remains.
    EXPECT_NEAR(uniformRadiance(field.at(s)), 0.5f, 0.02f) << p.z;
    ++seen;
  }
  EXPECT_GT(seen, 10);
}

TEST(DirectTransfer, InAClosedBoxIsDark) {
  for (const int cells : {1, 5}) {
    const Transport t(sceneOf({flipped(box({0, 0, 0}, {2, 3, 5}, cells))}));
    const auto field = t.direct();
    for (std::size_t s = 0; s < t.samples.size(); ++s)
      for (const float value : field.at(s)) EXPECT_LT(std::abs(value), 1e-4f);
  }
}

TEST(DirectTransfer, UnderUniformLightIsNeverAboveAlbedo) {
  // The scene is random intersecting triangles, with normals anywhere in the half space of their face.
  const Transport t(sceneOf({soup(11, 0.3f, 0.9f)}));
  const auto field = t.direct();
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    EXPECT_LE(uniformRadiance(field.at(s)), 1.0f + 1e-5f);
    EXPECT_GE(uniformRadiance(field.at(s)), -1e-5f);
  }
}

TEST(DirectTransfer, TurnsWithTheScene) {
  // The scene is an L of floor and wall, and the same rotated: transfer rotates by the SH rotation, up to the
  // effect of the table's pattern, which is fixed in each sample's own frame.
  const auto scene =
      joined(grid({0, 0, 0}, 2.0f, 6), transformed(turned(grid({0, 0, 0}, 2.0f, 6), -90.0f, {0, 0, 1}),
                                                   glm::translate(glm::mat4(1.0f), {-1.0f, 1.0f, 0})));
  const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), 1.1f, glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f)));
  const Transport still(sceneOf({scene})), moved(sceneOf({transformed(scene, turn)}));
  const auto a = still.direct(5, 2048), b = moved.direct(5, 2048);
  const sh::Rotation rotation(glm::dmat3(glm::mat3(turn)), 5);
  for (std::size_t v = 0; v < still.geometry.positions.size(); ++v) {
    std::vector<float> rotated(25);
    rotation.apply(a.at(still.samples.vertex_sample[v]), rotated);
    EXPECT_LT(largestDifference(rotated, b.at(moved.samples.vertex_sample[v])), 0.01f);
  }
}

TEST(DirectTransfer, OfASceneFarAwayIsThatOfTheSameSceneNear) {
  Scene scene = sceneOf({grid({0, 0, 0}, 4.0f, 8), icosphere({0, 1.2f, 0}, 1.0f, 3)});
  const auto local_by = Transport(scene).direct();
  for (gltf::Node& node : scene.nodes)
    node.parent_from_node = glm::translate(glm::mat4(1.0f), {1e6f, -2e6f, 4e6f});
  const Transport far_away(scene);
  EXPECT_GT(glm::length(far_away.geometry.origin), 4e6f);
  const auto field = far_away.direct();
  ASSERT_EQ(field.vectors.size(), local_by.vectors.size());
  // Samples keep their order; single rays past an edge may fall on its other side.
  EXPECT_LT(largestDifference(field.vectors, local_by.vectors), 5e-3f);
}

TEST(DirectTransfer, UnderABodyIsFilledFromOutside) {
  // A box is sunk into the floor: floor samples inside it see only backs of its faces.
  const auto floor = grid({0, 0, 0}, 4.0f, 40);
  const Transport t(sceneOf({floor, box({0, 0.3f, 0}, {1, 1, 1}, 4)}));
  const DirectResult direct = t.bake(5, 512, /*bounces=*/0).direct;
  const TransferField& field = direct.field;
  EXPECT_GT(direct.of(SurfacePart::Matte).filled_samples, 30u);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    const glm::vec3 p = t.samples.positions[s];
    if (std::abs(p.y) > 1e-6f || std::max(std::abs(p.x), std::abs(p.z)) > 0.45f) continue;
    EXPECT_GT(uniformRadiance(field.at(s)), 0.3f) << "darkness under the box would leak along its foot";
  }
}

TEST(DirectTransfer, OfATwoSidedCardIsWholeOnBothSides) {
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 4)});
  scene.materials[0].double_sided = true;
  const Transport t(scene);
  ASSERT_EQ(t.geometry.draws.size(), 2u);
  const auto field = t.direct();
  EXPECT_EQ(t.samples.size(), 50u);
  for (std::size_t s = 0; s < t.samples.size(); ++s)
    EXPECT_LT(largestDifference(field.at(s), open(5, t.samples.normals[s])), 1e-5f);
}

TEST(DirectTransfer, CutOutsBlockByTheirAlpha) {
  // The roof over the floor is solid, cut out completely by vertex alpha, or blended.
  Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 2), flipped(grid({0, 1.0f, 0}, 50.0f, 1))});
  gltf::Material& roof = testing::ownMaterial(scene, 1);
  const auto at_centre = [&] {
    const Transport t(scene);
    return uniformRadiance(t.direct().at(t.sampleAt({0, 0, 0})));
  };
  EXPECT_LT(at_centre(), 0.02f);
  roof.alpha_mode = gltf::AlphaMode::Mask;
  EXPECT_LT(at_centre(), 0.02f);
  roof.base_color.w = 0.4f;
  EXPECT_NEAR(at_centre(), 1.0f, 1e-5f);
  roof.alpha_mode = gltf::AlphaMode::Blend;
  EXPECT_NEAR(at_centre(), 1.0f, 1e-5f);
}

TEST(DirectTransfer, DegenerateTrianglesChangeNothing) {
  const auto sphere = icosphere({0, 1.2f, 0}, 1.0f, 3);
  auto spoilt = sphere;
  for (std::uint32_t v = 0; v + 2 < 200; v += 2)
    for (const std::uint32_t index : {v, v, v + 1}) spoilt.indices.push_back(index);
  const auto floor = grid({0, 0, 0}, 4.0f, 8);
  const Transport clean(sceneOf({floor, sphere})), dirty(sceneOf({floor, spoilt}));
  EXPECT_EQ(clean.direct().vectors, dirty.direct().vectors);
}

TEST(DirectTransfer, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Progress progress;
  for (const float metallic : {0.0f, 1.0f}) {
    Scene scene = sceneOf({grid({0, 0, 0}, 1.0f, 4)});
    scene.materials[0].metallic = metallic;
    const Transport t(scene, /*with_glossy=*/true);
    EXPECT_FALSE(bakeDirect(DirectPass(t.diffuse(), {.rays = 128}), {progress, stop.get_token()}));
  }
}

TEST(DirectTransfer, FindsTheSameHitsAgainForSingleSamples) {
  // Rays of a grid meet many edges, where either face may count as hit.
  const Transport t(sceneOf({grid({0.0f, 0.0f, 0.0f}, 4.0f, 12), grid({0.0f, 1.0f, 0.0f}, 4.0f, 12),
                             box({0.1f, 0.5f, -0.2f}, {1.0f, 1.0f, 1.0f}, 4)}));
  const TracedScene scene = t.diffuse();
  const DirectPass pass(scene, {.order = 3, .rays = 256, .keep_hits = true, .hit_memory = 1u << 30});
  Progress progress;
  const auto direct = bakeDirect(pass, {progress});
  const HitStore nothing(t.samples.size(), 0);
  std::size_t hits = 0;
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    const StoredHits kept(direct->of(SurfacePart::Matte).hits, pass, s, s + 1),
        again(nothing, pass, s, s + 1);
    ASSERT_EQ(kept.of(s).size(), again.of(s).size()) << "sample " << s;
    hits += kept.of(s).size();
    for (std::size_t h = 0; h < kept.of(s).size(); ++h) {
      const GatherHit &a = kept.of(s)[h], &b = again.of(s)[h];
      ASSERT_EQ(std::tie(a.ray, a.triangle, a.u, a.v), std::tie(b.ray, b.triangle, b.u, b.v))
          << "sample " << s;
      ASSERT_TRUE(std::ranges::equal(a.albedo, b.albedo)) << "sample " << s;
    }
  }
  EXPECT_GT(hits, 1000u);
}

}  // namespace
}  // namespace lambent::baker
