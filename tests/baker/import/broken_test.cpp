// Tests what importScene() refuses, and that the error names the object. With the address and undefined
// sanitizers it also shows that nothing is read out of bounds.
#include <random>

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::oneTriangle;
using testing::TemporaryFolder;

TEST(BrokenScene, IsRefusedWithTheNameOfTheObject) {
  const char* const draco = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  struct Case {
    const char* names;  // which the error must contain
    testing::Edits edits;
  };
  const std::vector<Case> cases{
      {"accessor 0", {{"/accessors/0/count", "4"}}},
      {"accessor 0", {{"/accessors/0/count", "6148914691236517206"}}},  // count * 12 wraps to 8
      {"accessor 0", {{"/accessors/0/count", "-1"}}},
      {"accessor 0", {{"/accessors/0/byteOffset", "4"}}},
      {"accessor 0", {{"/accessors/0/componentType", "5124"}}},
      {"accessor 0", {{"/accessors/0/type", R"("VEC5")"}}},
      {"accessor 0", {{"/accessors/0/type", R"("VEC2")"}}},
      {"accessor 0", {{"/accessors/0/bufferView", "4294967296"}}},  // 0 when cut to 32 bits
      {"accessor 0", {{"/accessors/0/bufferView", ""}, {"/accessors/0/count", "1073741824"}}},
      {"accessor 0: sparse", {{"/accessors/0/sparse", R"({"count":9})"}}},
      {"bufferView 0", {{"/bufferViews/0/byteOffset", "18446744073709551610"}}},
      {"bufferView 0", {{"/bufferViews/0/buffer", "1"}}},
      {"accessor 0", {{"/bufferViews/0/byteStride", "3"}}},
      {"accessor 0", {{"/bufferViews/0/byteStride", "8"}}},
      {"buffer 0", {{"/buffers/0/byteLength", "37"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("../scene.bin")"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("%2e%2e/scene.bin")"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("/etc/hostname")"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("file:///etc/hostname")"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("data:application/octet-stream;base64,AAAA")"}}},
      {"buffer 0", {{"/buffers/0/uri", R"("not there.bin")"}}},
      {"buffer 0", {{"/buffers/0/uri", ""}}},
      {"mesh 0, primitive 0", {{"/meshes/0/primitives/0/attributes/POSITION", "7"}}},
      {"mesh 0, primitive 0", {{"/meshes/0/primitives/0/material", "0"}}},
      {"mesh 0, primitive 0", {{"/meshes/0/primitives/0/mode", "7"}}},
      {"KHR_draco", {{draco, R"({"bufferView":9,"attributes":{}})"}}},
      {"mesh 0, primitive 0",
       {{"/meshes/0/primitives/0/indices", "0"}, {draco, R"({"bufferView":0,"attributes":{"POSITION":0}})"}}},
      {"without POSITION or indices", {{draco, R"({"bufferView":0,"attributes":{"POSITION":0}})"}}},
      {"node 0", {{"/nodes/0/mesh", "1"}}},
      {"node 0", {{"/nodes/0/children", "[0]"}}},
      {"node 1", {{"/nodes", R"([{"children":[1]},{"children":[2]},{"children":[1]}])"}}},
      {"node 0", {{"/nodes/0/rotation", "[0,0,1]"}}},
      {"node 0", {{"/nodes/0/scale", "[1e300,1,1]"}}},
      {"scene 0", {{"/scenes/0/nodes", "[3]"}}},
      {"scene 9", {{"/scene", "9"}}},
      {"stands twice", {{"/scenes/0/nodes", "[0,0]"}}},
      {"animation 0",
       {{"/animations",
         R"([{"channels":[{"sampler":0,"target":{"node":5}}],"samplers":[{"input":0,"output":0}]}])"}}},
      {"animation 0, channel 0", {{"/animations", R"([{"channels":[{"sampler":0,"target":{"node":0}}]}])"}}},
      {"animation 0, sampler 0", {{"/animations", R"([{"samplers":[{"input":0,"output":9}]}])"}}},
      {"skin 0", {{"/skins", R"([{"joints":[]}])"}}},
      {"skin 0", {{"/skins", R"([{"joints":[7]}])"}}},
      {"node 0", {{"/nodes/0/skin", "0"}}},
      {"node 0", {{"/nodes/0/weights", R"(["heavy"])"}}},
      {"mesh 0", {{"/meshes/0/weights", "1"}}},
      {"morph target 0", {{"/meshes/0/primitives/0/targets", R"([{"POSITION":4}])"}}},
      {"node 0", {{"/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION", "5"}}},
      {"node 0", {{"/nodes/0/extensions/KHR_lights_punctual/light", "0"}}},
      {"accessor 1 holds indices",
       {{"/accessors/1", R"({"componentType":5123,"count":3,"type":"SCALAR"})"},
        {"/meshes/0/primitives/0/indices", "1"}}},
      {"texture 0", {{"/textures", R"([{"source":0}])"}}},
      {"image 0", {{"/images", R"([{"bufferView":5}])"}}},
      {"2.1", {{"/asset/minVersion", R"("2.1")"}}},
      {"asset", {{"/asset", ""}}},
      {"no triangles", {{"/meshes/0/primitives/0/mode", "0"}}},
      // Sizes that floats cannot trace.
      {"node 0 (\"\") reaches 1e+12 m", {{"/nodes/0/scale", "[1e12,1,1]"}}},
      {"is only 1e-11 m large", {{"/nodes/0/scale", "[1e-11,1e-11,1e-11]"}}},
  };
  TemporaryFolder folder;
  for (std::size_t i = 0; i <= cases.size(); ++i) {
    GltfWriter writer = oneTriangle();
    writer.writeText(folder);
    const bool last = i == cases.size();
    if (last)
      for (int depth = 0; depth < 300; ++depth) writer.json["extras"] = {{"x", writer.json["extras"]}};
    else
      testing::edit(writer.json, cases[i].edits);
    const char* names = last ? "deeper" : cases[i].names;
    const auto scene = importScene(folder.write("scene.gltf", writer.json.dump()));
    ASSERT_FALSE(scene) << "case " << i << " (" << names << ")";
    EXPECT_NE(scene.error().line().find(names), std::string::npos) << i << ": " << scene.error().line();
    EXPECT_NE(scene.error().line().find("scene.gltf"), std::string::npos) << scene.error().line();
  }
}

TEST(BrokenScene, NamesIndicesPastTheVertices) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.primitive()["indices"] = writer.add<std::uint8_t>("SCALAR", 5121, {0, 1, 3}, 1);
  const auto scene = importScene(writer.writeText(folder));
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().problem.find("index 3"), std::string::npos);
}

TEST(BrokenScene, FollowsNoLinkOutOfItsFolder) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  folder.write("outside.bin", writer.bytes);
  writer.json["buffers"] = {{{"byteLength", writer.bytes.size()}, {"uri", "link.bin"}}};
  const auto path = folder.write("inside/scene.gltf", writer.json.dump());
  std::filesystem::create_symlink(folder.path() / "outside.bin", folder.path() / "inside" / "link.bin");
  const auto scene = importScene(path);
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().problem.find("outside"), std::string::npos);
}

TEST(BrokenScene, IsRefusedAtEveryTruncationOfAGlb) {
  TemporaryFolder folder;
  const std::string whole = oneTriangle().binary();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(importScene(folder.write("cut.glb", whole.substr(0, size)))) << size;
  EXPECT_TRUE(importScene(folder.write("whole.glb", whole)));
}

// Writes a file with something of everything: a skinned and morphed triangle that is instanced, animated, lit
// and textured.
GltfWriter everything() {
  GltfWriter writer = oneTriangle();
  json& attributes = writer.primitive()["attributes"];
  attributes["NORMAL"] = writer.add<float>("VEC3", 5126, {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  attributes["TANGENT"] = writer.add<float>("VEC4", 5126, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
  attributes["TEXCOORD_0"] = writer.add<float>("VEC2", 5126, {0, 0, 1, 0, 0, 1}, 2);
  attributes["JOINTS_0"] = writer.add<std::uint8_t>("VEC4", 5121, std::vector<std::uint8_t>(12, 0), 4);
  attributes["WEIGHTS_0"] = writer.add<float>("VEC4", 5126, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
  writer.primitive()["targets"] = {
      {{"POSITION", writer.add<float>("VEC3", 5126, std::vector<float>(9, 1), 3)}}};
  writer.primitive()["material"] = 0;
  writer.json["meshes"][0]["weights"] = {0.5};
  writer.json["nodes"] = json::parse(R"([{"mesh":0,"skin":0,"children":[1],"extensions":{
      "EXT_mesh_gpu_instancing":{"attributes":{}}}},{"extensions":{"KHR_lights_punctual":{"light":0}}}])");
  writer.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      writer.add<float>("VEC3", 5126, {1, 2, 3, 4, 5, 6}, 3);
  writer.json["skins"] = json::parse(R"([{"joints":[1]}])");
  writer.json["extensions"]["KHR_lights_punctual"]["lights"] =
      json::parse(R"([{"type":"spot","spot":{"innerConeAngle":0.2,"outerConeAngle":0.5},"range":3}])");
  writer.json["animations"] = json::parse(R"([{"samplers":[{}],"channels":[
      {"sampler":0,"target":{"node":1,"path":"translation"}}]}])");
  writer.json["animations"][0]["samplers"][0]["input"] = writer.add<float>("SCALAR", 5126, {0, 1}, 1);
  writer.json["animations"][0]["samplers"][0]["output"] =
      writer.add<float>("VEC3", 5126, {1, 2, 3, 4, 5, 6}, 3);
  writer.json["images"] = json::parse(std::string(R"([{"uri":")") + testing::kPngUri + "\"}]");
  writer.json["textures"] = json::parse(R"([{"source":0}])");
  writer.json["materials"] = json::parse(R"([{"normalTexture":{"index":0,"scale":2},
      "emissiveFactor":[1,1,1],"emissiveTexture":{"index":0,"extensions":{"KHR_texture_transform":
      {"offset":[1,2],"rotation":3}}},"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4},
      "KHR_materials_unlit":{}}}])");
  return writer;
}

TEST(BrokenScene, SurvivesFlippedBytes) {
  TemporaryFolder folder;
  std::mt19937 random(3);
  for (const std::string& whole : {oneTriangle().binary(), everything().binary()}) {
    EXPECT_TRUE(importScene(folder.write("whole.glb", whole)));
    for (int round = 0; round < 500; ++round) {
      std::string bytes = whole;
      for (int flips = 0; flips < 1 + round % 3; ++flips)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      const auto scene = importScene(folder.write("flipped.glb", bytes));
      EXPECT_TRUE(scene || scene.error().line().find('\n') == std::string::npos);
    }
  }
}

TEST(BrokenScene, NoFileOfTheValidatorsCorpusDoesHarm) {
  const auto corpus = testing::sharedFile("invalid/gltf-validator");
  LAMBENT_NEEDS_SHARED(corpus);
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    const auto scene = importScene(entry.path());
    if (!scene) {
      EXPECT_EQ(scene.error().line().find('\n'), std::string::npos);
    }
    ++files;
  }
  EXPECT_GE(files, 90);
}

}  // namespace
}  // namespace lambent::baker
