#include "baker/transport/ray_scene.hpp"

#include <algorithm>

#include "baker/transport/frame.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::Transport;

glm::mat3 upright() {
  return glm::mat3(localFrame({0, 1, 0}));
}

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
  // Half a roof, x > 0, from straight above to the horizon.
  const auto roof = testing::transformed(flipped(grid({0, 0, 0}, 1e5f, 1)),
                                         glm::translate(glm::mat4(1.0f), {5e4f, 1.0f, 0}));
  const Transport t(sceneOf({roof}));
  const SampleOrigin origin{{0, 0, 0}, {0, 1, 0}, 1.0f};
  const DirectionTable table = cosineTable(512);
  std::vector<std::uint16_t> masks(table.packets());
  EXPECT_EQ(t.rays.trace(std::span(&origin, 1), upright(), table, masks), 512u);
  for (std::size_t r = 0; r < table.size(); ++r) {
    const glm::vec3 d = upright() * glm::vec3(table.x[r], table.y[r], table.z[r]);
    EXPECT_EQ(masks[r / 16] >> (r % 16) & 1, d.x > 0.0f ? 1 : 0) << d.x;
  }
}

TEST(RayScene, BlocksBelowTheGeometricHorizonWithoutTracing) {
  const Transport t(sceneOf({grid({0, -100, 0}, 1.0f, 1)}));
  const glm::vec3 tilted = glm::normalize(glm::vec3(1, 1, 0));
  const SampleOrigin origin{{0, 0, 0}, tilted, 1.0f};
  const DirectionTable table = cosineTable(256);
  std::vector<std::uint16_t> masks(table.packets());
  const std::uint32_t traced = t.rays.trace(std::span(&origin, 1), upright(), table, masks);
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
  float share = 0.0f;
  {
    const Transport t(scene);
    t.rays.backFaceShare(std::span(&inside, 1), upright(), table, std::span(&share, 1));
    EXPECT_EQ(share, 1.0f);
    t.rays.backFaceShare(std::span(&outside, 1), upright(), table, std::span(&share, 1));
    EXPECT_EQ(share, 0.0f);
  }
  scene.materials[0].double_sided = true;  // then there is no back
  const Transport t(scene);
  t.rays.backFaceShare(std::span(&inside, 1), upright(), table, std::span(&share, 1));
  EXPECT_EQ(share, 0.0f);
}

}  // namespace
}  // namespace lambent::baker
