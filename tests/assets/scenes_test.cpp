// The scenes that ship are sound, stand on their floor, and come out the same byte for byte.
#include "assets/scenes.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <glm/common.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/assets/mesh_checks.hpp"

namespace lambent::assets {
namespace {

std::string written(const Scene& scene, const std::string& name) {
  const auto path = std::filesystem::path(::testing::TempDir()) / name;
  const Result<void> done = writeGlb(path, scene);
  EXPECT_TRUE(done) << done.error().line();
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  return bytes;
}

std::size_t vertexCount(const Scene& scene) {
  std::size_t count = 0;
  for (const Node& node : scene.nodes)
    count += scene.meshes[static_cast<std::size_t>(node.mesh)].mesh.positions.size();
  return count;
}

TEST(AssetsScenes, EveryMeshIsSound) {
  for (const Scene& scene : {gallery(), hello(), knot(), metals()})
    for (const MaterialMesh& mesh : scene.meshes) expectSound(mesh.mesh, scene.name + " " + mesh.name);
}

TEST(AssetsScenes, HaveTheSizeThatTheyPromise) {
  EXPECT_GT(vertexCount(gallery()), 60000u);
  EXPECT_LT(vertexCount(gallery()), 120000u);
  EXPECT_LT(vertexCount(hello()), 1000u);
  EXPECT_LT(vertexCount(knot()), 20000u);
  EXPECT_LT(vertexCount(metals()), 50000u);
}

TEST(AssetsScenes, WallsAndBoxesEncloseAPositiveVolume) {
  const Scene scene = gallery();
  for (const MaterialMesh& mesh : scene.meshes)
    if (mesh.name != "teapot") {
      EXPECT_GT(volume(mesh.mesh), 0.0) << mesh.name;
    }
  EXPECT_GT(volume(knot().meshes[0].mesh), 0.0);
}

TEST(AssetsScenes, NothingStandsBelowTheFloorOrOutsideTheRoom) {
  const Scene scene = gallery();
  for (const Node& node : scene.nodes) {
    if (node.name == "floor") continue;
    for (const glm::vec3 p : scene.meshes[static_cast<std::size_t>(node.mesh)].mesh.positions) {
      const glm::vec3 world = node.translation + node.scale * (node.rotation * p);
      ASSERT_GT(world.y, -1e-5f) << node.name;
      ASSERT_LT(glm::length(world), 4.5f) << node.name;
    }
  }
}

TEST(AssetsScenes, ComeOutByteForByteTheSame) {
  EXPECT_EQ(written(gallery(), "gallery_a.glb"), written(gallery(), "gallery_b.glb"));
}

TEST(AssetsScenes, AreBinaryGltfWithNamedCamerasAndTheirTexture) {
  const std::string bytes = written(gallery(), "gallery_c.glb");
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  std::uint32_t header[5];
  std::memcpy(header, bytes.data(), sizeof header);
  EXPECT_EQ(header[1], 2u);
  EXPECT_EQ(header[2], bytes.size());
  const auto json = nlohmann::json::parse(bytes.substr(20, header[3]));
  EXPECT_EQ(json["cameras"][0]["name"], "main");
  EXPECT_EQ(json["cameras"].size(), 2u);
  EXPECT_EQ(json["images"][0]["mimeType"], "image/png");
  for (const auto& material : json["materials"]) {
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0.0);
    EXPECT_EQ(material["extensions"]["KHR_materials_specular"]["specularFactor"], 0.0);
  }
  for (const auto& view : json["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
}

}  // namespace
}  // namespace lambent::assets
