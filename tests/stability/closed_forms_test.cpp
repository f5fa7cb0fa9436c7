// Compares whole bakes, from the scene through Draco and the codes and back, with known answers.
#include "tests/stability/end_to_end_bake.hpp"

namespace lambent {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::kCodingTolerance;
using testing::sceneOf;

using ClosedForm = testing::EndToEndBake;

TEST_F(ClosedForm, AClosedBoxIsDarkInside) {
  const bundle::MeshData outer = box({0, 0, 0}, {2, 2, 2}, 8);
  for (const auto& draw : bakeAndDecode(sceneOf({flipped(outer)})))
    for (std::size_t v = 0; v < draw.mesh.positions.size(); ++v)
      EXPECT_LT(std::abs(draw.uniformRadiance(v)), kCodingTolerance) << v;
  // The walls now have a thickness, and there is a ball inside.
  const auto draws = bakeAndDecode(
      sceneOf({outer, flipped(box({0, 0, 0}, {1.9f, 1.9f, 1.9f}, 8)), icosphere({0.2f, 0, 0}, 0.4f, 2)}));
  ASSERT_EQ(draws.size(), 3u);
  for (const std::size_t inside : {1u, 2u})
    for (std::size_t v = 0; v < draws[inside].mesh.positions.size(); ++v)
      EXPECT_LT(std::abs(draws[inside].uniformRadiance(v)), kCodingTolerance) << inside << " " << v;
  for (std::size_t v = 0; v < draws[0].mesh.positions.size(); ++v)
    EXPECT_NEAR(draws[0].uniformRadiance(v), 1.0f, kCodingTolerance) << v;
}

// At height h over a disc of radius r, the disc hides the cosine-weighted fraction r²/(r² + h²). In the
// middle of the plane under a ball of radius r with its centre at d, it is (r/d)².
TEST_F(ClosedForm, UnderABallTheFloorLosesTheSquareOfItsSine) {
  auto what_vertices_see = options();
  what_vertices_see.fit = false;
  const auto draws = bakeAndDecode(sceneOf({grid({0, 0, 0}, 4.0f, 16), icosphere({0, 1.25f, 0}, 1.0f, 4)}),
                                   what_vertices_see);
  ASSERT_EQ(draws.size(), 2u);
  bool met = false;
  for (std::size_t v = 0; v < draws[0].mesh.positions.size(); ++v)
    if (glm::length(draws[0].mesh.positions[v]) < 1e-3f) {
      met = true;
      // 256 stratified rays have an error of 1 %, and the facets of the ball hide a little less than the
      // ball.
      EXPECT_NEAR(draws[0].uniformRadiance(v), 1.0f - 0.64f, 0.01f);
    }
  EXPECT_TRUE(met);
}

}  // namespace lambent
