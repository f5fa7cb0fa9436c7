#include "baker/transport/group_geometry.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

// Alpha masks are looked up where the picture will be: KHR_texture_transform counts.
TEST(GroupGeometry, TexcoordsAreThoseOfTheTransformedBaseColorTexture) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 1.0f, 1)});
  scene.materials[0].base_color_texture = {
      .texture = 0, .offset = {0.5f, -1.0f}, .scale = {2.0f, 4.0f}, .rotation_rad = 1.57079632f};
  const bundle::MeshData& mesh = scene.meshes[0].primitives[0].mesh;
  const auto geometry = buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}});
  ASSERT_EQ(geometry.texcoords.size(), mesh.texcoords0.size());
  for (std::size_t v = 0; v < mesh.texcoords0.size(); ++v) {
    // A quarter turn takes (u, v) to (v, -u), as the extension writes its matrix.
    const glm::vec2 uv = mesh.texcoords0[v];
    EXPECT_NEAR(geometry.texcoords[v].x, 0.5f + 4.0f * uv.y, 1e-6f);
    EXPECT_NEAR(geometry.texcoords[v].y, -1.0f - 2.0f * uv.x, 1e-6f);
  }
}

}  // namespace
}  // namespace lambent::baker
