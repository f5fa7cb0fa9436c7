#include "baker/transport/group_geometry.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

// Alpha masks are sampled with KHR_texture_transform applied.
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

// A mirroring node flips the bitangent, and so does the back, whose normal is negated; the direction in which
// the surface is brushed stays.
TEST(GroupGeometry, GivesGlossyDrawsTangentsAndBothSetsOfTexcoords) {
  bundle::MeshData mesh = testing::grid({0, 0, 0}, 1.0f, 1);
  mesh.tangents.assign(mesh.positions.size(), {1.0f, 0.0f, 0.0f, 1.0f});
  for (const glm::vec2& uv : mesh.texcoords0) mesh.texcoords1.push_back(3.0f * uv);
  for (const float mirror : {1.0f, -1.0f}) {
    Scene scene = testing::sceneOf({mesh});
    scene.materials[0].metallic = 1.0f;
    scene.materials[0].double_sided = true;
    scene.nodes[0].parent_from_node = glm::scale(glm::mat4(1.0f), glm::vec3(1.0f, 1.0f, 2.0f * mirror));
    const auto geometry =
        buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}}, /*with_glossy=*/true);
    ASSERT_EQ(geometry.draws.size(), 2u);
    ASSERT_EQ(geometry.tangents.size(), geometry.positions.size());
    for (const DrawGeometry& draw : geometry.draws)
      for (std::size_t v = 0; v < draw.vertex_count; ++v) {
        const std::size_t at = draw.first_vertex + v;
        EXPECT_EQ(geometry.texcoord_sets[0][at], mesh.texcoords0[v]);
        EXPECT_EQ(geometry.texcoord_sets[1][at], mesh.texcoords1[v]);
        const glm::vec4 tangent = geometry.tangents[at];
        EXPECT_EQ(glm::vec3(tangent), glm::vec3(1.0f, 0.0f, 0.0f));
        // In the mesh cross(+Y, +X) = -Z; the node may take that to +Z.
        EXPECT_EQ(tangent.w * glm::cross(geometry.normals[at], glm::vec3(tangent)),
                  glm::vec3(0.0f, 0.0f, -mirror));
      }
  }
}

TEST(GroupGeometry, OfMatteScenesCarriesNothingForGlossyOnes) {
  bundle::MeshData mesh = testing::grid({0, 0, 0}, 1.0f, 1);
  const Scene scene = testing::sceneOf({mesh});
  const auto geometry =
      buildGroupGeometry(findRigidGroups(scene).at(0), scene, {{mesh}}, /*with_glossy=*/true);
  EXPECT_TRUE(geometry.tangents.empty());
  EXPECT_TRUE(geometry.texcoord_sets[0].empty());
}

}  // namespace
}  // namespace lambent::baker
