// Imports third-party scenes and models: counts must match their list, and the variants of one model must
// agree.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

struct Drawn {
  std::size_t draws = 0, vertices = 0, triangles = 0;
  double area = 0.0;  // world space
  glm::vec3 low{1e30f}, high{-1e30f};
};

Drawn drawn(const Scene& scene) {
  Drawn sum;
  const auto world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    for (const ScenePrimitive& primitive :
         scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives) {
      const bundle::MeshData& mesh = primitive.mesh;
      ++sum.draws;
      sum.vertices += mesh.positions.size();
      sum.triangles += mesh.indices.size() / 3;
      EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
      for (const glm::vec3& normal : mesh.normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        glm::vec3 p[3];
        for (std::size_t c = 0; c < 3; ++c) {
          p[c] = glm::vec3(world[n] * glm::vec4(mesh.positions.at(mesh.indices[i + c]), 1.0f));
          sum.low = glm::min(sum.low, p[c]);
          sum.high = glm::max(sum.high, p[c]);
        }
        sum.area += 0.5 * glm::length(glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]),
                                                 glm::dvec3(p[2]) - glm::dvec3(p[0])));
      }
    }
  }
  return sum;
}

struct Sample {
  const char* name;
  std::vector<const char*> files;
  std::size_t draws, vertices, triangles;  // vertices 0: the file has none to count (flat normals unweld)
};

TEST(Samples, CountsAreThoseOfTheListAndVariantsAgree) {
  const std::filesystem::path root = testing::sharedFile("scenes/khronos");
  LAMBENT_NEEDS_SHARED(root);
  const std::vector<Sample> samples{
      {"Box",
       {"glTF/Box.gltf", "glTF-Binary/Box.glb", "glTF-Draco/Box.gltf", "glTF-Embedded/Box.gltf"},
       1,
       24,
       12},
      {"Box With Spaces", {"glTF/Box With Spaces.gltf"}, 1, 24, 12},
      {"BoxInterleaved", {"glTF/BoxInterleaved.gltf", "glTF-Binary/BoxInterleaved.glb"}, 1, 24, 12},
      {"BoxVertexColors", {"glTF-Binary/BoxVertexColors.glb"}, 1, 24, 12},
      {"BoxAnimated", {"glTF-Binary/BoxAnimated.glb"}, 2, 320, 254},
      {"AnimatedMorphCube",
       {"glTF/AnimatedMorphCube.gltf", "glTF-Binary/AnimatedMorphCube.glb",
        "glTF-Quantized/AnimatedMorphCube.gltf"},
       1,
       24,
       12},
      {"Duck",
       {"glTF/Duck.gltf", "glTF-Binary/Duck.glb", "glTF-Draco/Duck.gltf", "glTF-Embedded/Duck.gltf",
        "glTF-Quantized/Duck.gltf"},
       1,
       2399,
       4212},
      {"CesiumMan", {"glTF-Binary/CesiumMan.glb", "glTF-Draco/CesiumMan.gltf"}, 1, 0, 4672},
      {"DamagedHelmet", {"glTF-Binary/DamagedHelmet.glb"}, 1, 14556, 15452},
      {"Fox", {"glTF-Binary/Fox.glb"}, 1, 1728, 576},
      {"MeshPrimitiveModes", {"glTF/MeshPrimitiveModes.gltf"}, 3, 0, 16},
      {"OrientationTest", {"glTF-Binary/OrientationTest.glb"}, 13, 1048, 524},
      {"SimpleSparseAccessor",
       {"glTF/SimpleSparseAccessor.gltf", "glTF-Embedded/SimpleSparseAccessor.gltf"},
       1,
       0,
       12},
      {"Suzanne", {"glTF/Suzanne.gltf"}, 1, 11808, 3936},
      {"TriangleWithoutIndices", {"glTF/TriangleWithoutIndices.gltf"}, 1, 3, 1},
  };
  for (const Sample& sample : samples) {
    Drawn first;
    for (const char* file : sample.files) {
      SCOPED_TRACE(std::string(sample.name) + "/" + file);
      const auto scene = importScene(root / sample.name / file);
      ASSERT_TRUE(scene) << scene.error().line();
      const Drawn sum = drawn(*scene);
      EXPECT_EQ(sum.draws, sample.draws);
      EXPECT_EQ(sum.triangles, sample.triangles);
      if (sample.vertices != 0) {
        EXPECT_EQ(sum.vertices, sample.vertices);
      }
      if (file == sample.files.front()) first = sum;
      // Draco and quantized variants keep 11 to 14 bits of each axis.
      EXPECT_NEAR(sum.area / first.area, 1.0, 5e-3);
      const float size = glm::length(first.high - first.low);
      EXPECT_LT(glm::length(sum.low - first.low) + glm::length(sum.high - first.high), 2e-3f * size);
    }
  }
}

TEST(Samples, FilesOfTheCompatibilityListLoadAndOfALaterVersionAreRefused) {
  const std::filesystem::path root = testing::sharedFile("scenes/asset-generator/Compatibility");
  LAMBENT_NEEDS_SHARED(root);
  for (int i = 0; i < 6; ++i) {
    const auto scene = importScene(root / ("Compatibility_0" + std::to_string(i) + ".gltf"));
    ASSERT_EQ(scene.has_value(), i != 4) << i;
    if (i == 4) {
      EXPECT_NE(scene.error().problem.find("2.1"), std::string::npos);
    }
    if (i == 5) {  // it requires what only concerns looks
      EXPECT_NE(scene->warnings.at(0).find("FAKE_materials_quantumRendering"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace lambent::baker
