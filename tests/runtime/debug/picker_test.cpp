// Tests that picking returns what the picture shows.
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/debug/data_view.hpp"
#include "tests/support/frame/live_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::LiveStage;
using testing::quadMesh;

using testing::kWhite;

glm::mat4 at(glm::vec3 place) {
  return glm::translate(glm::mat4(1.0f), place);
}

std::optional<Picked> pick(LiveStage& stage, float x, float y) {
  const auto picked = stage.frame->pick(stage.world, stage.view(), x, y);
  EXPECT_TRUE(picked) << picked.error().line();
  return picked ? *picked : std::nullopt;
}

// Returns the index of a draw within its bundle, or -1 for none.
int drawAt(LiveStage& stage, float x, float y) {
  const auto picked = pick(stage, x, y);
  const auto& draws = stage.world.instance(0).draws;
  for (std::size_t i = 0; picked && i < draws.size(); ++i)
    if (draws[i] == picked->draw) return static_cast<int>(i);
  return -1;
}

}  // namespace

using PickerTest = testing::GpuTest;

TEST_F(PickerTest, EveryPixelOfADrawIsPickedAsIt) {
  // Colours tell the draws apart; a quad of holes stands before two others.
  BundleBuilder builder;
  gltf::Material holes;
  holes.alpha_mode = gltf::AlphaMode::Mask;
  std::vector<std::uint8_t> checks;
  for (int i = 0; i < 64; ++i)
    for (const int channel : {0, 1, 2, 3})
      checks.push_back(
          static_cast<std::uint8_t>(channel == 0 || (channel == 3 && (i + i / 8) % 2 == 0) ? 255 : 0));
  holes.base_color_texture.texture = builder.addTexture(8, 8, checks,
                                                        {.wrap_s = GL_CLAMP_TO_EDGE,
                                                         .wrap_t = GL_CLAMP_TO_EDGE,
                                                         .mag_filter = GL_NEAREST,
                                                         .min_filter = GL_NEAREST});
  gltf::Material green, blue;
  green.base_color = {0, 1, 0, 1};
  blue.base_color = {0, 0, 1, 1};
  blue.double_sided = true;
  builder.add({quadMesh(), holes, at({0, 0, 0.5f})});
  builder.add({quadMesh(), green, at({-0.8f, 0, 0})});
  builder.add(
      {quadMesh(), blue, at({0.9f, 0, -0.3f}) * glm::rotate(glm::mat4(1.0f), 3.0f, glm::vec3(0, 1, 0))});
  LiveStage stage(builder, {kWhite});
  stage.environment.setIntensity(0.5f);
  const auto picture = stage.picture();
  std::map<int, int> found;
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) {
      const glm::vec4& texel = picture[y * 64 + x];
      int expected = -1;
      if (texel.a == 1.0f) expected = texel.r > 0.4f ? 0 : texel.g > 0.4f ? 1 : 2;
      const int drawn = drawAt(stage, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      ++found[drawn];
      // Draws 2 and 3 are the sides of the two-sided one.
      ASSERT_EQ(std::min(drawn, 2), expected) << x << ", " << y;
    }
  for (const int draw : {-1, 0, 1, 3}) EXPECT_GT(found[draw], 20) << draw;
  EXPECT_FALSE(pick(stage, -1.0f, 3.0f));
  EXPECT_FALSE(pick(stage, 64.0f, 3.0f));
}

TEST_F(PickerTest, SaysWhereAndWhatStandsThere) {
  gltf::Material material;
  const auto turn = glm::rotate(glm::mat4(1.0f), 0.3f, glm::vec3(1, 0, 0));
  LiveStage stage(BundleBuilder()
                      .groupRotation(glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3))))
                      .add({quadMesh(), material, at({0, 0, 2}) * turn}),
                  {kWhite});
  stage.camera.azimuth_deg = stage.camera.elevation_deg = 0.0f;
  stage.render();
  const auto picked = pick(stage, 32.0f, 32.0f);
  ASSERT_TRUE(picked);
  const scene::SceneInstance& instance = stage.world.instance(0);
  EXPECT_EQ(picked->draw, instance.draws[0]);
  EXPECT_EQ(picked->node, instance.nodes[0]);
  EXPECT_EQ(picked->group, instance.groups[0]);
  EXPECT_EQ(picked->material, instance.materials[0]);
  EXPECT_LT(glm::distance(picked->position_ws, glm::vec3(0, 0, 2)), 1e-3f);
  EXPECT_LT(glm::distance(picked->normal_ws, glm::vec3(turn * glm::vec4(0, 0, 1, 0))), 1e-3f);
}

}  // namespace lambent::frame
