// Tests the depths of pictures: along the camera's axis, of the first opaque surface.
#include <algorithm>
#include <limits>

#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

// Makes a square of 2 m at height y, seen from 5 m above the ground by a camera that looks straight down.
std::vector<float> depthsOf(const Scene& scene, float fov_deg) {
  Scene seen = scene;
  testing::lookAt(seen, {0, 5, 0}, {0, 0, 0}, fov_deg);
  const Report report =
      testing::rendered(seen, {.lights = {testing::uniform(1.0f)}, .options = {.size = {33, 33}, .spp = 2}});
  EXPECT_EQ(report.image.depths.size(), 33u * 33u);
  return report.image.depths;
}

std::size_t count(const std::vector<float>& depths, float depth) {
  return static_cast<std::size_t>(std::ranges::count_if(depths, [depth](float d) {
    return depth == kNone ? d == kNone : std::abs(d - depth) < 2e-6f * depth;
  }));
}

TEST(Depth, IsAlongTheAxisAndNotAlongTheRay) {
  // The floor fills the picture. In its corners rays are 1.4 times as long.
  const std::vector<float> depths = depthsOf(testing::sceneOf({testing::grid({0, 0, 0}, 20.0f, 4)}), 70.0f);
  EXPECT_EQ(count(depths, 5.0f), depths.size());
}

TEST(Depth, IsInfiniteWhereNothingStands) {
  // The square takes 2 of 20 m, the middle fifth.
  const std::vector<float> depths =
      depthsOf(testing::sceneOf({testing::grid({0, 0, 0}, 2.0f, 4)}), 2.0f * 63.434949f);
  EXPECT_EQ(count(depths, 5.0f) + count(depths, kNone), depths.size());
  EXPECT_EQ(count(depths, 5.0f), 9u) << "3 x 3 of 33 x 33 pixels of 0.606 m";
}

TEST(Depth, OfBlendedSurfacesIsWhatStandsBehindThem) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 20.0f, 4), testing::grid({0, 2, 0}, 20.0f, 4),
                                  testing::grid({0, 3, 0}, 20.0f, 4)});
  gltf::Material glass = testing::matte();
  glass.alpha_mode = gltf::AlphaMode::Blend;
  for (const float alpha : {0.0f, 0.5f, 1.0f}) {
    glass.base_color.a = alpha;
    testing::paint(scene, 1, glass);
    testing::paint(scene, 2, glass);
    const std::vector<float> depths = depthsOf(scene, 40.0f);
    EXPECT_EQ(count(depths, 5.0f), depths.size()) << alpha;
  }
  testing::paint(scene, 0, glass);
  const std::vector<float> nothing = depthsOf(scene, 40.0f);
  EXPECT_EQ(count(nothing, kNone), nothing.size());
}

}  // namespace
}  // namespace lambent::baker::reference
