// Imports every third-party scene that is available: each is read or refused in one line, and all variants of
// one model have the same geometry.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "runtime/bundle/material_fields.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> gltfFilesUnder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// Checks what every user of a scene relies on.
void expectWhole(const Scene& scene) {
  ASSERT_FALSE(scene.meshes.empty());
  for (const SceneMesh& mesh : scene.meshes)
    for (const ScenePrimitive& primitive : mesh.primitives) {
      const bundle::MeshData& data = primitive.mesh;
      ASSERT_EQ(data.normals.size(), data.positions.size());
      ASSERT_LT(primitive.material, static_cast<std::int32_t>(scene.materials.size()));
      ASSERT_TRUE(data.tangents.empty() || data.tangents.size() == data.positions.size());
      for (const std::uint32_t index : data.indices) ASSERT_LT(index, data.positions.size());
      for (const glm::vec4& tangent : data.tangents) {
        ASSERT_EQ(std::abs(tangent.w), 1.0f);
        ASSERT_NEAR(glm::length(glm::vec3(tangent)), 1.0f, 1e-5f);
      }
    }
  for (const gltf::Node& node : scene.nodes) {
    ASSERT_LT(node.mesh, static_cast<std::int32_t>(scene.meshes.size()));
    ASSERT_LT(node.light, static_cast<std::int32_t>(scene.lights.size()));
    ASSERT_EQ(node.animated, node.trs.has_value());
  }
  for (const gltf::Material& material : scene.materials)
    gltf::forEachMaterialTexture([&](const auto& field) {
      const gltf::TextureRef& ref = material.*field.member;
      ASSERT_LT(ref.texture, static_cast<std::int32_t>(scene.textures.size()));
      ASSERT_LE(ref.texcoord, 1u);
    });
}

TEST(SharedScenes, AreAllReadOrRefusedInOneLine) {
  const fs::path root = testing::sharedFile("scenes");
  LAMBENT_NEEDS_SHARED(root);
  std::size_t read = 0;
  for (const char* folder : {"scenes", "invalid"})
    for (const fs::path& file : gltfFilesUnder(testing::sharedFile(folder))) {
      SCOPED_TRACE(file.string());
      const auto scene = importScene(file);
      if (scene) {
        ++read;
        expectWhole(*scene);
      } else {
        EXPECT_EQ(scene.error().line().find('\n'), std::string::npos);
        EXPECT_NE(scene.error().line().find(file.filename().string()), std::string::npos);
        EXPECT_FALSE(scene.error().hint.empty());
      }
    }
  // All files of scenes/ are read, except two of Compatibility/, one node with two parents, and the points
  // and lines.
  EXPECT_GE(read, 95u);
}

struct Geometry {
  std::size_t triangles = 0;
  double area = 0.0;  // world space
  glm::dvec3 low{1e30}, high{-1e30};
};

Geometry geometryOf(const Scene& scene) {
  Geometry sum;
  const auto world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    for (const ScenePrimitive& primitive :
         scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives) {
      const bundle::MeshData& mesh = primitive.mesh;
      sum.triangles += mesh.indices.size() / 3;
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        glm::dvec3 p[3];
        for (std::size_t c = 0; c < 3; ++c) {
          p[c] = glm::dvec3(world[n] * glm::vec4(mesh.positions[mesh.indices[i + c]], 1.0f));
          sum.low = glm::min(sum.low, p[c]);
          sum.high = glm::max(sum.high, p[c]);
        }
        sum.area += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
      }
    }
  }
  return sum;
}

TEST(SharedScenes, VariantsOfOneModelAreTheSameGeometry) {
  const fs::path root = testing::sharedFile("scenes/khronos");
  LAMBENT_NEEDS_SHARED(root);
  std::map<std::string, std::vector<fs::path>> models;
  for (const fs::path& file : gltfFilesUnder(root))
    models[fs::relative(file, root).begin()->string()].push_back(file);
  std::size_t compared = 0;
  const std::map<std::string, std::size_t> triangles = {// of the models' pages
                                                        {"Box", 12},         {"Duck", 4212},
                                                        {"CesiumMan", 4672}, {"DamagedHelmet", 15452},
                                                        {"Fox", 576},        {"Suzanne", 3936}};
  for (const auto& [model, files] : models) {
    const auto first = importScene(files.front());
    ASSERT_TRUE(first) << first.error().line();
    const Geometry expected = geometryOf(*first);
    if (const auto known = triangles.find(model); known != triangles.end()) {
      EXPECT_EQ(expected.triangles, known->second) << model;
    }
    const double diagonal = glm::length(expected.high - expected.low);
    for (std::size_t i = 1; i < files.size(); ++i) {
      SCOPED_TRACE(files[i].string());
      const auto scene = importScene(files[i]);
      ASSERT_TRUE(scene) << scene.error().line();
      const Geometry found = geometryOf(*scene);
      EXPECT_EQ(found.triangles, expected.triangles);
      // Draco and quantized variants keep 11 to 16 bits of an axis. Measured: 1.8e-4 and 2.3e-5 at most.
      EXPECT_LT(glm::length(found.low - expected.low), 1e-3 * diagonal);
      EXPECT_LT(glm::length(found.high - expected.high), 1e-3 * diagonal);
      EXPECT_NEAR(found.area / expected.area, 1.0, 1e-3);
      EXPECT_EQ(scene->animations.size(), first->animations.size());
      ++compared;
    }
  }
  EXPECT_GE(compared, 16u);
}

TEST(SharedScenes, FiguresStandAsTheirJointsPutThem) {
  const fs::path root = testing::sharedFile("scenes/khronos");
  LAMBENT_NEEDS_SHARED(root);
  // Heights as the models' pages show them: a man of 1.5 m, feet on the ground; a fox of 79 cm in
  // centimetres.
  for (const auto& [file, height, up] : {std::tuple{"CesiumMan/glTF-Binary/CesiumMan.glb", 1.5, 1},
                                         std::tuple{"Fox/glTF-Binary/Fox.glb", 79.0, 1}}) {
    const auto scene = importScene(root / file);
    ASSERT_TRUE(scene) << scene.error().line();
    const Geometry figure = geometryOf(*scene);
    EXPECT_NEAR((figure.high - figure.low)[up], height, 0.05 * height) << file;
    EXPECT_NEAR(figure.low[up], 0.0, 0.02 * height) << file;
  }
}

}  // namespace
}  // namespace lambent::baker
