// Tests tangents against what the rules of MikkTSpace give on meshes that can be worked out by hand.
#include <cmath>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "baker/import/mesh_edits.hpp"

namespace lambent::baker {
namespace {

// Two triangles in the plane z = 0, seen from +z, that share the edge from (0, 0) to (0, 1), left and right
// of it. u is x if `mirrored` is false, else |x|.
bundle::MeshData twoFaces(bool mirrored) {
  bundle::MeshData mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  for (const glm::vec3& p : mesh.positions) mesh.texcoords0.push_back({mirrored ? std::abs(p.x) : p.x, -p.y});
  mesh.indices = {0, 1, 2, 1, 0, 3};
  return mesh;
}

void expectTangent(const glm::vec4& tangent, const glm::vec4& expected, const char* what) {
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(tangent[i], expected[i], 1e-6f) << what;
}

}  // namespace

TEST(Tangents, PointAlongUWithUpRightPicturesToTheLeftOfThem) {
  bundle::MeshData mesh = twoFaces(false);
  makeTangents(mesh, {});
  ASSERT_EQ(mesh.tangents.size(), 4u) << "no vertex is split";
  // v points down, as in glTF, so the bitangent w cross(n, t) = +y is up in the picture.
  for (const glm::vec4& tangent : mesh.tangents) expectTangent(tangent, {1, 0, 0, 1}, "upright");
}

TEST(Tangents, SplitVerticesWhereThePictureIsMirrored) {
  bundle::MeshData mesh = twoFaces(true);
  mesh.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}};
  makeTangents(mesh, {});
  ASSERT_EQ(mesh.tangents.size(), 6u) << "both vertices of the edge";
  ASSERT_EQ(mesh.positions.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i) expectTangent(mesh.tangents[mesh.indices[i]], {-1, 0, 0, -1}, "left");
  for (std::size_t i = 3; i < 6; ++i) expectTangent(mesh.tangents[mesh.indices[i]], {1, 0, 0, 1}, "right");
  EXPECT_EQ(mesh.colors[mesh.indices[3]], glm::vec4(0, 1, 0, 1)) << "the copy has all attributes";
}

// At (0, 0) the left face has 90 degrees and the right one, lower, 45.
TEST(Tangents, AreMeansByAngles) {
  bundle::MeshData mesh = twoFaces(false);
  mesh.positions[3] = {1, 1, 0};
  mesh.texcoords0[3] = {1, 0};  // so that u grows along (1, 0) on the left and (1/2, 1/2)... on the right
  makeTangents(mesh, {});
  ASSERT_EQ(mesh.tangents.size(), 4u);
  // The right face maps (0, 1) to uv (0, -1) and (1, 1) to (1, 0), so that u grows along (1, 1) - (0, 1) -
  // v's share: dp/du = (1, 1, 0).
  const glm::vec3 left(1, 0, 0), right = glm::normalize(glm::vec3(1, 1, 0));
  expectTangent(mesh.tangents[0], glm::vec4(glm::normalize(2.0f * left + right), 1), "90 and 45 degrees");
  expectTangent(mesh.tangents[1], glm::vec4(glm::normalize(left + 2.0f * right), 1), "45 and 90 degrees");
  expectTangent(mesh.tangents[2], glm::vec4(left, 1), "left alone");
  expectTangent(mesh.tangents[3], glm::vec4(right, 1), "right alone");
}

TEST(Tangents, AreThoseOfThePointAndNotOfTheVertex) {
  bundle::MeshData joined = twoFaces(false);
  joined.positions[3] = {1, 1, 0};
  joined.texcoords0[3] = {1, 0};
  bundle::MeshData apart = joined;
  for (auto* list : {&apart.positions, &apart.normals})
    *list = {(*list)[0], (*list)[1], (*list)[2], (*list)[1], (*list)[0], (*list)[3]};
  apart.texcoords0 = {joined.texcoords0[0], joined.texcoords0[1], joined.texcoords0[2],
                      joined.texcoords0[1], joined.texcoords0[0], joined.texcoords0[3]};
  apart.indices = {0, 1, 2, 3, 4, 5};
  const std::vector<std::uint32_t> indices = joined.indices;
  makeTangents(joined, {});
  makeTangents(apart, {});
  for (std::size_t i = 0; i < 6; ++i)
    expectTangent(apart.tangents[i], joined.tangents[indices[i]], "equal vertices count as one");
}

TEST(Tangents, FollowTheTextureTransformAndItsCoordinates) {
  bundle::MeshData mesh = twoFaces(false);
  mesh.texcoords1 = mesh.texcoords0;
  mesh.texcoords0.assign(4, {0, 0});
  gltf::TextureRef map{.texcoord = 1};
  map.scale = {-1, 1};
  makeTangents(mesh, map);
  for (const glm::vec4& tangent : mesh.tangents) expectTangent(tangent, {-1, 0, 0, -1}, "mirrored");
  mesh = twoFaces(false);
  makeTangents(mesh, map);
  EXPECT_TRUE(mesh.tangents.empty()) << "there is no TEXCOORD_1";
}

TEST(Tangents, LieInTheSurfaceWhereThePictureHasNoArea) {
  bundle::MeshData mesh = twoFaces(false);
  mesh.texcoords0.assign(4, {0.5f, 0.5f});
  makeTangents(mesh, {});
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1.0f, 1e-6f);
    EXPECT_EQ(tangent.z, 0.0f);
  }
  // A face without area in the picture takes the tangents of its neighbor.
  mesh = twoFaces(false);
  mesh.texcoords0[3] = mesh.texcoords0[1];
  makeTangents(mesh, {});
  ASSERT_EQ(mesh.tangents.size(), 4u);
  expectTangent(mesh.tangents[0], {1, 0, 0, 1}, "of the left");
}

}  // namespace lambent::baker
