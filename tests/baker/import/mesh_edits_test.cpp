// Tests tangents against what the rules of MikkTSpace give on meshes that can be worked out by hand, and the
// splitting of edges.
#include "baker/import/mesh_edits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"

namespace lambent::baker {
namespace {

using bundle::MeshData;
using Point = std::array<float, 3>;
using Edge = std::pair<Point, Point>;

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

Point key(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

double area(const MeshData& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                     c = mesh.positions[mesh.indices[i + 2]];
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

// Counts the triangles at each edge; edges are identified by the positions of their ends.
std::map<Edge, int> edges(const MeshData& mesh) {
  std::map<Edge, int> count;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    const Point a = key(mesh.positions[mesh.indices[i]]), b = key(mesh.positions[mesh.indices[next]]);
    ++count[std::minmax(a, b)];
  }
  return count;
}

// Makes a closed box with hard edges: every side has its own vertices, normals and texture coordinates, and
// the sides differ so much that adjacent ones are split differently.
MeshData box(glm::vec3 size) {
  MeshData mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      glm::vec3 normal(0.0f);
      normal[axis] = side == 0 ? -1.0f : 1.0f;
      for (int corner = 0; corner < 4; ++corner) {
        glm::vec3 p(0.0f);
        p[axis] = static_cast<float>(side) * size[axis];
        p[(axis + 1) % 3] = static_cast<float>(corner & 1) * size[(axis + 1) % 3];
        p[(axis + 2) % 3] = static_cast<float>(corner >> 1) * size[(axis + 2) % 3];
        mesh.positions.push_back(p + glm::vec3(0.1f, 0.7f, -0.3f));  // places that are not exact in binary
        mesh.normals.push_back(normal);
        mesh.texcoords0.emplace_back(corner & 1, corner >> 1);
      }
      if (side == 0) {
        mesh.indices.insert(mesh.indices.end(),
                            {first, first + 2, first + 1, first + 1, first + 2, first + 3});
      } else {
        mesh.indices.insert(mesh.indices.end(),
                            {first, first + 1, first + 2, first + 1, first + 3, first + 2});
      }
    }
  }
  return mesh;
}

// An edge that is doubled at a seam, with its ends in the other order, is split at the same place.
TEST(SplitMarkedEdges, LeavesAClosedMeshClosedWhereverEdgesAreSplit) {
  MeshData mesh = box({1.3f, 0.2f, 3.7f});
  const double before = area(mesh);
  const auto first = [&](std::uint32_t v) {
    const glm::vec3& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  for (int pass = 0; pass < 4; ++pass)
    splitMarkedEdges(mesh, [&](std::uint32_t a, std::uint32_t b) {
      return first(a) < first(b) ? 9001.0f / 65536.0f : 1.0f - 9001.0f / 65536.0f;
    });
  EXPECT_NEAR(area(mesh), before, 1e-5 * before);
  for (const auto& [edge, count] : edges(mesh)) ASSERT_EQ(count, 2);
}

TEST(SplitMarkedEdges, TakesNormalsAndTangentsAtTheSameShareAsPositionsWhicheverEndComesFirst) {
  for (const bool turned : {false, true}) {
    MeshData mesh;
    mesh.positions = {{turned ? 4 : 0, 0, 0}, {turned ? 0 : 4, 0, 0}, {2, 0, 3}};
    mesh.normals = {{0, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.tangents = {{0, 0, 1, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    mesh.indices = {0, 1, 2};
    splitMarkedEdges(mesh, [](std::uint32_t a, std::uint32_t b) {
      return a == 0 && b == 1 ? 0.25f : a == 1 && b == 0 ? 0.75f : 0.0f;
    });
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[3].x, turned ? 3.0f : 1.0f);
    EXPECT_LT(glm::distance(mesh.normals[3], glm::normalize(glm::vec3(0.25f, 0.75f, 0.0f))), 1e-6f) << turned;
    EXPECT_LT(glm::distance(glm::vec3(mesh.tangents[3]), glm::normalize(glm::vec3(0.0f, 0.25f, 0.75f))),
              1e-6f);
  }
}

TEST(SplitLongEdges, InterpolatesAttributesAndKeepsNormalsUnit) {
  MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  mesh.texcoords0 = {{0, 0}, {1, 0}, {0, 1}};
  mesh.colors = {{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}};
  mesh.tangents = {{1, 0, 0, -1}, {0, 1, 0, -1}, {-1, 0, 0, -1}};  // two of them opposite: they have no mean
  mesh.indices = {0, 1, 2};
  ASSERT_TRUE(splitLongEdges(mesh, 0.2f, 1000));
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1.0f, 1e-6f);
    EXPECT_EQ(tangent.w, -1.0f);
  }
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    // Texture coordinates and colours are linear in position: midpoints keep them so, exactly (powers of
    // two).
    EXPECT_EQ(mesh.texcoords0[v], glm::vec2(mesh.positions[v]));
    EXPECT_EQ(mesh.colors[v], glm::vec4(mesh.positions[v], 1.0f) * glm::vec4(1, 1, 0, 1));
    EXPECT_NEAR(glm::length(mesh.normals[v]), 1.0f, 1e-6f);
  }
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)  // winding
    EXPECT_GT(glm::cross(mesh.positions[mesh.indices[i + 1]] - mesh.positions[mesh.indices[i]],
                         mesh.positions[mesh.indices[i + 2]] - mesh.positions[mesh.indices[i]])
                  .z,
              0.0f);
}

TEST(SplitLongEdges, TurnsNormalsOverThePartsAsOverTheWhole) {
  // Normals that differ by up to 100 degrees, as at the corners of coarse scans.
  MeshData whole;
  whole.positions = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
  whole.normals = {glm::normalize(glm::vec3(-0.9f, -0.2f, 0.5f)), glm::normalize(glm::vec3(0.8f, 0.1f, 0.6f)),
                   glm::normalize(glm::vec3(0.1f, 0.9f, 0.4f))};
  whole.indices = {0, 1, 2};
  MeshData parts = whole;
  ASSERT_TRUE(splitLongEdges(parts, 0.2f, 10'000));
  ASSERT_EQ(parts.normal_weights.size(), parts.normals.size());
  const auto interpolated = [](const MeshData& mesh, std::size_t triangle, const glm::vec3& shares) {
    glm::vec3 sum(0.0f);
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = mesh.indices[triangle + static_cast<std::size_t>(c)];
      sum += shares[c] * (mesh.normal_weights.empty() ? 1.0f : mesh.normal_weights[v]) * mesh.normals[v];
    }
    return glm::normalize(sum);
  };
  for (std::size_t i = 0; i < parts.indices.size(); i += 3)
    for (const glm::vec3 shares :
         {glm::vec3(0.6f, 0.3f, 0.1f), glm::vec3(1.0f / 3.0f), glm::vec3(0.05f, 0.05f, 0.9f)}) {
      glm::vec3 p(0.0f);
      for (int c = 0; c < 3; ++c)
        p += shares[c] * parts.positions[parts.indices[i + static_cast<std::size_t>(c)]];
      const glm::vec3 in_whole(1.0f - p.x - p.y, p.x, p.y);
      EXPECT_LT(glm::distance(interpolated(parts, i, shares), interpolated(whole, 0, in_whole)), 1e-5f);
    }
}

TEST(SplitLongEdges, ChangesNothingWhereEdgesAreShortOrTheGuardSteps) {
  MeshData mesh = box({1, 1, 1});
  const MeshData before = mesh;
  EXPECT_TRUE(splitLongEdges(mesh, 2.0f, 12));
  EXPECT_EQ(mesh.indices, before.indices);
  EXPECT_FALSE(splitLongEdges(mesh, 0.01f, 1000));
  EXPECT_EQ(mesh.indices, before.indices);
  EXPECT_EQ(mesh.positions.size(), before.positions.size());
  // Edges so short that floats cannot halve them end at the guard too.
  EXPECT_FALSE(splitLongEdges(mesh, 1e-12f, 100000));
}

}  // namespace
}  // namespace lambent::baker
