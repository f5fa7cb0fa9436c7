#include "runtime/bundle/mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "baker/compress/draco_encode.hpp"
#include "tests/support/differences.hpp"

namespace lambent::bundle {
namespace {

using baker::EncodedMesh;
using baker::encodeDraco;

constexpr float kStep = 1.0f / 4096.0f;

// Makes an n x n grid of quads over [x0, x0 + 1] x [0, 1], bent into a bump so that normals differ.
MeshData bump(int n, float x0 = 0.0f) {
  MeshData mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const float x = x0 + static_cast<float>(i) / static_cast<float>(n);
      const float z = static_cast<float>(j) / static_cast<float>(n);
      mesh.positions.emplace_back(x, 0.3f * std::sin(3.0f * x) * std::cos(2.0f * z), z);
      mesh.normals.push_back(glm::normalize(glm::vec3(-0.9f * std::cos(3.0f * x) * std::cos(2.0f * z), 1.0f,
                                                      0.6f * std::sin(3.0f * x) * std::sin(2.0f * z))));
      mesh.texcoords0.emplace_back(x, z);
    }
  }
  const auto row = static_cast<std::uint32_t>(n + 1);
  for (std::uint32_t j = 0; j + 1 < row; ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + row, a + 1, a + 1, a + row, a + row + 1});
    }
  }
  return mesh;
}

Primitive announce(const EncodedMesh& encoded) {
  Primitive primitive;
  primitive.attributes = encoded.attributes;
  primitive.vertex_count = static_cast<std::uint32_t>(encoded.decoded.positions.size());
  primitive.index_count = static_cast<std::uint32_t>(encoded.decoded.indices.size());
  return primitive;
}

EncodedMesh encoded(const MeshData& mesh, float step = kStep) {
  auto result = encodeDraco(mesh, step, "mesh");
  EXPECT_TRUE(result) << (result ? "" : result.error().line());
  return result ? std::move(*result) : EncodedMesh{};
}

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
Key bits(const glm::vec3& p) {
  return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
          std::bit_cast<std::uint32_t>(p.z)};
}

TEST(DracoMesh, DecodesToLatticePointsWithinHalfAStep) {
  const MeshData mesh = bump(20);
  const EncodedMesh out = encoded(mesh);
  ASSERT_EQ(out.decoded.indices.size(), mesh.indices.size());
  ASSERT_EQ(out.decoded.positions.size(), mesh.positions.size());
  std::set<Key> decoded;
  for (const glm::vec3& p : out.decoded.positions) decoded.insert(bits(p));
  for (const glm::vec3& p : mesh.positions)
    EXPECT_TRUE(decoded.contains(bits(glm::round(p / kStep) * kStep + 0.0f)));
}

TEST(DracoMesh, PrimitivesThatShareAnEdgeStillShareItToTheBit) {
  // Two meshes with different boxes share the plane x = 1.
  const EncodedMesh left = encoded(bump(17, 0.0f)), right = encoded(bump(17, 1.0f));
  std::set<Key> right_edge;
  for (const glm::vec3& p : right.decoded.positions)
    if (p.x == 1.0f) right_edge.insert(bits(p));
  std::size_t shared = 0;
  for (const glm::vec3& p : left.decoded.positions) {
    if (p.x != 1.0f) continue;
    EXPECT_TRUE(right_edge.contains(bits(p)));
    ++shared;
  }
  EXPECT_EQ(shared, 18u);
}

TEST(DracoMesh, StaysOnTheLatticeFarFromTheOriginAndAtTinyAndHugeSteps) {
  for (const float step :
       {std::ldexp(1.0f, -40), std::ldexp(1.0f, -17), std::ldexp(1.0f, -3), std::ldexp(1.0f, 20)}) {
    MeshData mesh = bump(6);
    // 2^12 steps wide, 2^22 steps away: more than Draco's own explicit quantization could say in decimal
    // text.
    for (glm::vec3& p : mesh.positions)
      p = (p * 4096.0f + glm::vec3(4194304.0f, -4194304.0f, 12345.0f)) * step;
    const EncodedMesh out = encoded(mesh, step);
    ASSERT_FALSE(out.decoded.positions.empty());
    for (const glm::vec3& p : out.decoded.positions) EXPECT_EQ(p / step, glm::round(p / step));
  }
}

TEST(DracoMesh, NormalsAreUnitAndWithinATwentiethOfADegree) {
  std::mt19937 random(7);
  std::normal_distribution<float> gauss;
  MeshData mesh = bump(100);
  for (glm::vec3& n : mesh.normals)
    n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
  const EncodedMesh out = encoded(mesh);
  std::map<Key, glm::vec3> normal_at;
  for (std::size_t i = 0; i < out.decoded.positions.size(); ++i)
    normal_at[bits(out.decoded.positions[i])] = out.decoded.normals[i];
  double worst = 0.0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 decoded = normal_at.at(bits(glm::round(mesh.positions[i] / kStep) * kStep + 0.0f));
    EXPECT_NEAR(glm::length(decoded), 1.0f, 1e-6f);
    worst = testing::larger(
        worst, std::asin(glm::length(glm::cross(glm::dvec3(decoded), glm::dvec3(mesh.normals[i])))));
  }
  RecordProperty("worst_degrees", std::to_string(worst * 180.0 / std::numbers::pi));
  EXPECT_LT(worst * 180.0 / std::numbers::pi, 0.05);
}

TEST(DracoMesh, WeightsOfNormalsKeepWithinHalfOf255thsAndNormalsTakeThem) {
  MeshData mesh = bump(12);
  std::map<Key, float> weight_at;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    mesh.normal_weights.push_back(0.2f +
                                  0.8f * static_cast<float>(i) / static_cast<float>(mesh.normals.size()));
    weight_at[bits(glm::round(mesh.positions[i] / kStep) * kStep + 0.0f)] = mesh.normal_weights[i];
  }
  EncodedMesh out = encoded(mesh);
  ASSERT_EQ(out.decoded.normal_weights.size(), out.decoded.normals.size());
  for (std::size_t i = 0; i < out.decoded.normals.size(); ++i) {
    EXPECT_NEAR(glm::length(out.decoded.normals[i]), 1.0f, 1e-6f);
    EXPECT_NEAR(out.decoded.normal_weights[i], weight_at.at(bits(out.decoded.positions[i])),
                0.5f / 255.0f + 1e-6f);
  }
  const std::vector<float> weights = out.decoded.normal_weights;
  weighNormals(out.decoded);
  EXPECT_TRUE(out.decoded.normal_weights.empty());
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_NEAR(glm::length(out.decoded.normals[i]), weights[i], 1e-6f);
  EXPECT_TRUE(encoded(bump(12)).decoded.normal_weights.empty());  // where nothing was split
}

TEST(DracoMesh, TexcoordsAndColorsKeepTheirBounds) {
  MeshData mesh = bump(12);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.texcoords0[i] = mesh.texcoords0[i] * 5.0f - 2.0f;
    mesh.texcoords1.emplace_back(mesh.positions[i].z, mesh.positions[i].x);
    mesh.colors.emplace_back(mesh.positions[i].x, 0.5f, 1.0f, mesh.positions[i].z);
  }
  const EncodedMesh out = encoded(mesh);
  ASSERT_EQ(out.decoded.colors.size(), out.decoded.positions.size());
  for (std::size_t i = 0; i < out.decoded.positions.size(); ++i) {
    // The attributes are functions of position, which itself moved by half a step at most.
    const glm::vec3 p = out.decoded.positions[i];
    EXPECT_NEAR(out.decoded.texcoords0[i].x, p.x * 5.0f - 2.0f, 2.5f * kStep + 2.5f / 65535.0f);
    EXPECT_NEAR(out.decoded.texcoords1[i].x, p.z, 0.5f * kStep + 0.5f / 65535.0f);
    EXPECT_NEAR(out.decoded.colors[i].x, p.x, 0.5f * kStep + 0.5f / 65535.0f);
    EXPECT_NEAR(out.decoded.colors[i].y, 0.5f, 0.5f / 65535.0f);
    EXPECT_EQ(out.decoded.colors[i].z, 1.0f);
  }
}

TEST(DracoMesh, TangentsAreUnitWithinAThirtiethOfADegreeAndKeepTheirSign) {
  MeshData mesh = bump(40);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 along = glm::normalize(glm::cross(mesh.normals[i], glm::vec3(0, 0, 1)));
    mesh.tangents.emplace_back(along, mesh.positions[i].x < 0.5f ? -1.0f : 1.0f);
  }
  const EncodedMesh out = encoded(mesh);
  ASSERT_EQ(out.decoded.tangents.size(), out.decoded.positions.size());
  ASSERT_EQ(out.decoded.positions.size(), mesh.positions.size());
  std::map<Key, glm::vec4> tangent_at;
  for (std::size_t i = 0; i < out.decoded.positions.size(); ++i)
    tangent_at[bits(out.decoded.positions[i])] = out.decoded.tangents[i];
  double worst = 0.0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec4 decoded = tangent_at.at(bits(glm::round(mesh.positions[i] / kStep) * kStep + 0.0f));
    EXPECT_EQ(decoded.w, mesh.tangents[i].w);
    EXPECT_NEAR(glm::length(glm::vec3(decoded)), 1.0f, 1e-6f);
    worst =
        testing::larger(worst, glm::length(glm::cross(glm::dvec3(decoded), glm::dvec3(mesh.tangents[i]))));
  }
  RecordProperty("worst_degrees", std::to_string(std::asin(worst) * 180.0 / std::numbers::pi));
  // The tolerance is half a step of 2/4095 on two of the axes.
  EXPECT_LT(std::asin(worst) * 180.0 / std::numbers::pi, 0.03);
}

TEST(DracoMesh, SurvivesShapesThatConnectivityCodersTripOver) {
  MeshData triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.normals.assign(3, {0, 0, 1});
  triangle.indices = {0, 1, 2};
  EXPECT_EQ(encoded(triangle).decoded.indices.size(), 3u);

  MeshData fins = triangle;  // three triangles on one edge, one of them doubled, and an unused vertex
  fins.positions.insert(fins.positions.end(), {{0, -1, 0}, {0, 0, 1}, {5, 5, 5}});
  fins.normals.assign(6, {0, 0, 1});
  fins.indices = {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 4};
  EXPECT_EQ(encoded(fins).decoded.indices.size(), 12u);

  MeshData collapsed = fins;  // one triangle is smaller than the lattice
  collapsed.positions.push_back({0, 0, 1e-6f});
  collapsed.normals.push_back({0, 0, 1});
  collapsed.indices.insert(collapsed.indices.end(), {0, 6, 1});
  EXPECT_EQ(encoded(collapsed).decoded.indices.size(), 12u);

  MeshData bow;  // two triangles that touch in a corner
  bow.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  bow.normals.assign(5, {0, 0, 1});
  bow.indices = {0, 1, 2, 0, 3, 4};
  EXPECT_EQ(encoded(bow).decoded.indices.size(), 6u);
}

TEST(DecodeDraco, NamesCountsAndAttributesThatDiffer) {
  const EncodedMesh out = encoded(bump(3));
  Primitive wrong = announce(out);
  ++wrong.vertex_count;
  EXPECT_FALSE(decodeDraco(out.bytes, wrong, "mesh"));
  wrong = announce(out);
  wrong.index_count -= 3;
  EXPECT_FALSE(decodeDraco(out.bytes, wrong, "mesh"));
  wrong = announce(out);
  wrong.attributes.color0 = 9;
  const auto missing = decodeDraco(out.bytes, wrong, "mesh 4");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().subject, "mesh 4");
  wrong = announce(out);
  std::swap(wrong.attributes.position, wrong.attributes.texcoord0);  // two components where three belong
  EXPECT_FALSE(decodeDraco(out.bytes, wrong, "mesh"));
}

TEST(DecodeDraco, RefusesEveryTruncation) {
  const EncodedMesh out = encoded(bump(5));
  const Primitive primitive = announce(out);
  for (std::size_t size = 0; size < out.bytes.size(); ++size)
    EXPECT_FALSE(decodeDraco(std::span(out.bytes).first(size), primitive, "mesh")) << size;
}

TEST(DecodeDraco, SurvivesFlippedBytes) {
  // The mesh has no texture coordinates: a forged orientation count there makes Draco 1.5.5 loop for seconds,
  // though safely.
  MeshData mesh = bump(8);
  mesh.texcoords0.clear();
  const EncodedMesh out = encoded(mesh);
  const Primitive primitive = announce(out);
  std::mt19937 random(11);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::byte> bytes = out.bytes;
    for (int flips = 0; flips < 1 + round % 4; ++flips)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() & 0xff);
    const auto decoded = decodeDraco(bytes, primitive, "mesh");
    if (!decoded) continue;
    // What passes is whole: in range, finite, unit.
    ASSERT_EQ(decoded->positions.size(), primitive.vertex_count);
    for (const std::uint32_t v : decoded->indices) ASSERT_LT(v, primitive.vertex_count);
    for (const glm::vec3& n : decoded->normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
  }
}

TEST(MeshDigest, SeesPositionsAndIndicesOnly) {
  MeshData mesh = bump(3);
  const std::uint64_t digest = meshDigest(mesh);
  mesh.texcoords0.clear();
  EXPECT_EQ(meshDigest(mesh), digest);
  std::swap(mesh.indices[0], mesh.indices[1]);
  EXPECT_NE(meshDigest(mesh), digest);
  std::swap(mesh.indices[0], mesh.indices[1]);
  mesh.positions[5].x += 1e-6f;
  EXPECT_NE(meshDigest(mesh), digest);
}

TEST(WorldTransforms, ComposeWhateverTheOrderOfNodes) {
  std::vector<gltf::Node> nodes(3);
  const auto shift = [](float x) {
    glm::mat4 m(1.0f);
    m[3].x = x;
    return m;
  };
  nodes[0].parent = 2, nodes[0].parent_from_node = shift(1.0f);
  nodes[1].parent = 0, nodes[1].parent_from_node = shift(10.0f);
  nodes[2].parent_from_node = shift(100.0f);
  const auto world = gltf::worldTransforms(nodes);
  EXPECT_EQ(world[2][3].x, 100.0f);
  EXPECT_EQ(world[0][3].x, 101.0f);
  EXPECT_EQ(world[1][3].x, 111.0f);
}

}  // namespace
}  // namespace lambent::bundle
