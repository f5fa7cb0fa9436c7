// Tests what importScene() supports, on small files written here.
#include "baker/import/gltf.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "baker/import/scene_files.hpp"
#include "tests/baker/import/gltf_writer.hpp"

namespace lambent::baker {
namespace {

using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::TemporaryFolder;
using Indices = std::vector<std::uint32_t>;

const bundle::MeshData& firstMesh(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0).mesh;
}

TEST(ImportScene, ReadsTextAndBinaryAlike) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  for (const Scene& scene : {imported(writer.writeText(folder)), imported(writer.writeBinary(folder))}) {
    const bundle::MeshData& mesh = firstMesh(scene);
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.indices, (Indices{0, 1, 2}));
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST(ImportScene, MakesFlatNormalsWhereThereAreNone) {
  TemporaryFolder folder;
  GltfWriter writer;
  writer.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  writer.primitive()["indices"] = writer.add<std::uint16_t>("SCALAR", 5123, {0, 1, 2, 0, 3, 1}, 1);
  const Scene scene = imported(writer.writeText(folder));
  const bundle::MeshData& mesh = firstMesh(scene);
  ASSERT_EQ(mesh.normals.size(), 6u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(mesh.normals[static_cast<std::size_t>(i)], glm::vec3(0, 0, 1));
  for (int i = 3; i < 6; ++i) EXPECT_EQ(mesh.normals[static_cast<std::size_t>(i)], glm::vec3(0, 1, 0));
}

TEST(ImportScene, NormalizesNormalsAndRepairsThoseWithoutDirection) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.primitive()["attributes"]["NORMAL"] =
      writer.add<float>("VEC3", 5126, {0, 0, 4, 0, 0, 0, 3, 0, 0}, 3);
  const Scene scene = imported(writer.writeText(folder));
  EXPECT_EQ(firstMesh(scene).normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 0, 1}, {1, 0, 0}}));
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(ImportScene, TurnsStripsAndFansIntoTrianglesWithTheirWinding) {
  TemporaryFolder folder;
  const std::vector<float> strip{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0},
      fan{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (const auto& [mode, positions, triangles] : {std::tuple{5, strip, 3u}, std::tuple{6, fan, 2u}}) {
    GltfWriter writer;
    writer.addPositions(positions);
    writer.primitive()["mode"] = mode;
    const Scene scene = imported(writer.writeText(folder));
    ASSERT_EQ(firstMesh(scene).indices.size(), triangles * 3);
    for (const glm::vec3& n : firstMesh(scene).normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  }
}

TEST(ImportScene, LeavesPointsAndLinesOutWithAWarning) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  nlohmann::json lines = writer.primitive();
  lines["mode"] = 1;
  writer.json["meshes"][0]["primitives"].push_back(lines);
  const Scene scene = imported(writer.writeText(folder));
  EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("mesh 0, primitive 1"), std::string::npos);
}

TEST(ImportScene, ReadsColorsOfAllTypesAsLinear) {
  TemporaryFolder folder;
  const auto colors = [&](auto add) {
    GltfWriter writer = oneTriangle();
    writer.primitive()["attributes"]["COLOR_0"] = add(writer);
    writer.json["accessors"].back()["normalized"] = writer.json["accessors"].back()["componentType"] != 5126;
    return firstMesh(imported(writer.writeText(folder))).colors.at(1);
  };
  EXPECT_EQ(colors([](GltfWriter& w) {
              return w.add<float>("VEC3", 5126, {0, 0, 0, 0.25f, 0.5f, 1, 0, 0, 0}, 3);
            }),
            glm::vec4(0.25f, 0.5f, 1.0f, 1.0f));
  EXPECT_EQ(colors([](GltfWriter& w) {
              return w.add<std::uint8_t>("VEC4", 5121, {0, 0, 0, 0, 51, 102, 255, 0, 0, 0, 0, 0}, 4);
            }),
            glm::vec4(51.0f / 255.0f, 102.0f / 255.0f, 1.0f, 0.0f));
  EXPECT_EQ(colors([](GltfWriter& w) {
              return w.add<std::uint16_t>("VEC4", 5123, {0, 0, 0, 0, 13107, 65535, 0, 65535, 0, 0, 0, 0}, 4);
            }),
            glm::vec4(13107.0f / 65535.0f, 1.0f, 0.0f, 1.0f));
}

TEST(ImportScene, ReadsInterleavedQuantizedAndSparseAccessors) {
  TemporaryFolder folder;
  GltfWriter writer;
  // Per vertex: 3 shorts of position, 1 of padding, 4 bytes of which 3 are the normal.
  std::string vertices;
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{100, 0}, std::pair{0, 100}}) {
    const std::int16_t position[4] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), 0, 0};
    const std::int8_t normal[4] = {0, 0, 127, 0};
    vertices.append(reinterpret_cast<const char*>(position), 8)
        .append(reinterpret_cast<const char*>(normal), 4);
  }
  writer.bytes = vertices;
  writer.json["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 36}, {"byteStride", 12}});
  writer.json["accessors"] = {{{"bufferView", 0}, {"componentType", 5122}, {"count", 3}, {"type", "VEC3"}},
                              {{"bufferView", 0},
                               {"byteOffset", 8},
                               {"componentType", 5120},
                               {"normalized", true},
                               {"count", 3},
                               {"type", "VEC3"}}};
  writer.primitive()["attributes"] = {{"POSITION", 0}, {"NORMAL", 1}};
  writer.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  // The third vertex is moved to (0, 50, 0).
  writer.add<std::uint8_t>("SCALAR", 5121, {2}, 1);
  writer.add<std::int16_t>("VEC3", 5122, {0, 50, 0}, 3);
  writer.json["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", 1}, {"componentType", 5121}}},
                                           {"values", {{"bufferView", 2}}}};
  const Scene scene = imported(writer.writeText(folder));
  EXPECT_EQ(firstMesh(scene).positions, (std::vector<glm::vec3>{{0, 0, 0}, {100, 0, 0}, {0, 50, 0}}));
  EXPECT_EQ(firstMesh(scene).normals[0], glm::vec3(0, 0, 1));
}

TEST(ImportScene, DropsBrokenAndDegenerateTrianglesWithWarnings) {
  TemporaryFolder folder;
  GltfWriter writer;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  writer.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, 0.5f, 0, 0});
  writer.primitive()["indices"] =
      writer.add<std::uint32_t>("SCALAR", 5125, {0, 1, 2, 0, 3, 2, 0, 4, 1, 1, 1, 2}, 1);
  const Scene scene = imported(writer.writeText(folder));
  EXPECT_EQ(firstMesh(scene).indices.size(), 3u);
  EXPECT_EQ(firstMesh(scene).positions.size(), 3u);
  EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST(ImportScene, ReadsTheTreeOfTheDefaultSceneOnly) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["scenes"] = nlohmann::json::parse(R"([{"nodes":[0]},{"nodes":[1,4]}])");
  writer.json["scene"] = 1;
  writer.json["nodes"] = nlohmann::json::parse(R"([{"mesh":0},
    {"name":"root","translation":[1,2,3],"rotation":[0,0,0.70710678,0.70710678],"scale":[2,2,-2],"children":[3,2]},
    {"name":"lens","camera":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]},
    {"name":"child","mesh":0,"extras":{"lambent":{"movable":true}}},
    {"name":"other","mesh":0}])");
  writer.json["cameras"] =
      nlohmann::json::parse(R"([{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}])");
  writer.json["animations"] = nlohmann::json::parse(
      R"([{"channels":[{"sampler":0,"target":{"node":4,"path":"rotation"}},
                       {"sampler":0,"target":{"node":3,"path":"weights"}},
                       {"sampler":0,"target":{"node":0,"path":"rotation"}}],"samplers":[{}]}])");
  writer.json["animations"][0]["samplers"][0]["input"] = writer.add<float>("SCALAR", 5126, {0}, 1);
  writer.json["animations"][0]["samplers"][0]["output"] = writer.add<float>("VEC4", 5126, {0, 0, 0, 1}, 4);
  const Scene scene = imported(writer.writeText(folder));
  ASSERT_EQ(scene.nodes.size(), 4u);
  EXPECT_EQ(scene.roots, (std::vector<std::int32_t>{0, 3}));
  EXPECT_EQ(scene.nodes[0].name, "root");
  EXPECT_EQ(scene.nodes[0].children, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(scene.nodes[1].name, "child");
  EXPECT_EQ(scene.nodes[1].parent, 0);
  EXPECT_TRUE(scene.nodes[1].movable);
  EXPECT_FALSE(scene.nodes[1].animated);  // morph weights move no node
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("morph weights"), std::string::npos);
  EXPECT_EQ(scene.nodes[2].camera, 0);
  EXPECT_FLOAT_EQ(scene.cameras[0].yfov_rad, 0.5f);
  EXPECT_EQ(scene.cameras[0].zfar, 0.0f);
  EXPECT_TRUE(scene.nodes[3].animated);
  ASSERT_EQ(scene.animations.size(), 1u);
  ASSERT_EQ(scene.animations[0].channels.size(), 1u);  // the other node stands in no scene
  EXPECT_EQ(scene.animations[0].channels[0].node, 3u);
  EXPECT_EQ(scene.meshes.size(), 1u);  // one mesh, two instances

  // T * R * S: +X goes to +Y doubled, +Z is mirrored.
  const auto world = gltf::worldTransforms(scene.nodes);
  const glm::vec4 p = world[1] * glm::vec4(1, 0, 1, 1);
  EXPECT_NEAR(p.x, 1.0f, 1e-6f);
  EXPECT_NEAR(p.y, 4.0f, 1e-6f);
  EXPECT_NEAR(p.z, 1.0f, 1e-6f);
  EXPECT_LT(glm::determinant(world[1]), 0.0f);
  EXPECT_EQ(world[2][3].z, 3.0f - 10.0f);
}

TEST(ImportScene, ReadsMaterialsAndOnlyTheImagesThatTheyUse) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.primitive()["attributes"]["TEXCOORD_0"] = writer.add<float>("VEC2", 5126, {0, 0, 1, 0, 0, 1}, 2);
  writer.primitive()["material"] = 1;
  writer.json["materials"] =
      nlohmann::json::parse(R"([{},{"name":"leaf","doubleSided":true,"alphaMode":"MASK",
    "alphaCutoff":0.25,"emissiveFactor":[1,0.5,0],"occlusionTexture":{"index":0},"pbrMetallicRoughness":{
    "baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0,"roughnessFactor":0.5,
    "baseColorTexture":{"index":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,3]}}}}}])");
  writer.json["textures"] = nlohmann::json::parse(R"([{"source":0},{"source":1,"sampler":0}])");
  writer.json["samplers"] = nlohmann::json::parse(R"([{"wrapS":33071,"minFilter":9729}])");
  writer.json["images"] = nlohmann::json::parse(R"([{"uri":"missing.png"},{"uri":"a%20leaf.png"}])");
  folder.write("a leaf.png", testing::kPngFile);
  const Scene scene = imported(writer.writeText(folder));
  const gltf::Material& leaf = scene.materials.at(1);
  EXPECT_EQ(leaf.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_EQ(leaf.alpha_mode, gltf::AlphaMode::Mask);
  EXPECT_EQ(leaf.alpha_cutoff, 0.25f);
  EXPECT_TRUE(leaf.double_sided);
  EXPECT_EQ(leaf.emissive, glm::vec3(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(leaf.base_color_texture.texture, 0);
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, -1);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].sampler.wrap_s, 33071u);
  EXPECT_EQ(scene.textures[0].sampler.wrap_t, 10497u);
  EXPECT_EQ(scene.images.at(0).mime_type, "image/png");
  EXPECT_EQ(scene.images.at(0).name, "a leaf.png");
  // The transform stays with the texture: the coordinates are those of the file.
  EXPECT_EQ(leaf.base_color_texture.offset, glm::vec2(0.5f, 0.0f));
  EXPECT_EQ(leaf.base_color_texture.scale, glm::vec2(2.0f, 3.0f));
  EXPECT_EQ(firstMesh(scene).texcoords0, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
}

TEST(ImportScene, ReadsDataUrisOfAnyMediaTypeForBuffersAndImages) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.primitive()["material"] = 0;
  writer.json["materials"] =
      nlohmann::json::parse(R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])");
  writer.json["textures"] = nlohmann::json::parse(R"([{"source":0}])");
  writer.json["images"] = {{{"uri", testing::kPngUri}}};
  writer.json["buffers"] = {{{"byteLength", 36}}};
  for (const char* uri :
       {"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA",
        "data:application/gltf-buffer,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00"
        "%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00%00"}) {
    writer.json["buffers"][0]["uri"] = uri;
    const Scene scene = imported(folder.write("scene.gltf", writer.json.dump()));
    EXPECT_EQ(firstMesh(scene).positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << uri;
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].mime_type, "image/png");
    EXPECT_EQ(scene.images[0].file_bytes.size(), testing::kPngFile.size());
  }
}

TEST(ImportScene, ReadsFilesOutsideItsFolderOnlyWhenAllowed) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["buffers"] = {{{"byteLength", writer.bytes.size()}}};
  const auto buffer = folder.write("outside/scene.bin", writer.bytes);
  for (const std::string& uri : {std::string("../outside/scene.bin"), buffer.string()}) {
    writer.json["buffers"][0]["uri"] = uri;
    const auto path = folder.write("inside/scene.gltf", writer.json.dump());
    const auto refused = importScene(path);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().line().find("--allow-outside"), std::string::npos) << refused.error().line();
    EXPECT_TRUE(importScene(path, {.allow_outside = true}));
  }
}

TEST(ImportScene, WarnsAboutAnUnknownExtensionOnceAndRefusesItByNameWhereItHoldsGeometry) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["extensionsUsed"] = {"ACME_sparkle", "ACME_sparkle", "KHR_mesh_quantization"};
  const Scene scene = imported(writer.writeText(folder));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("ACME_sparkle"), std::string::npos);
  writer.json["extensionsUsed"] = {"KHR_materials_sheen", "KHR_materials_clearcoat"};
  const Scene glossy = imported(writer.writeText(folder));
  ASSERT_EQ(glossy.warnings.size(), 1u);
  EXPECT_NE(glossy.warnings[0].find("KHR_materials_clearcoat, KHR_materials_sheen"), std::string::npos);
  for (const char* name :
       {"KHR_materials_iridescence", "KHR_materials_variants", "KHR_xmp_json_ld", "ACME_sparkle"}) {
    writer.json["extensionsUsed"] = writer.json["extensionsRequired"] = {name};
    writer.primitive()["extensions"][name] = nlohmann::json::object();
    const Scene read = imported(writer.writeText(folder));
    ASSERT_EQ(read.warnings.size(), 1u) << name;
    EXPECT_NE(read.warnings[0].find(name), std::string::npos);
  }
  // Bytes that only the extension decodes, in place of the accessor's or of the view's.
  GltfWriter coded = writer, filtered = writer;
  coded.json["accessors"][0].erase("bufferView");
  filtered.json["bufferViews"][0]["extensions"]["ACME_sparkle"] = nlohmann::json::object();
  for (const GltfWriter& geometry : {coded, filtered})
    EXPECT_NE(testing::refusal(geometry, folder).find("the extension ACME_sparkle"), std::string::npos);
}

TEST(Uri, NamesTheFileThatOtherSystemsFind) {
  TemporaryFolder folder;
  const auto scene = folder.write("scene.gltf", "{}");
  folder.write("Textures/Old Wood.PNG", "wood");
  folder.write("100%.png", "percent");
  folder.write("a%20b.png", "raw");
  const auto read = [&](const char* uri, std::size_t warnings_expected) {
    std::vector<std::string> warnings;
    const auto bytes = resultOf("", "read", "", [&] { return readUri(scene, uri, {}, "image 0", warnings); });
    EXPECT_EQ(warnings.size(), warnings_expected) << uri;
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size())
                 : bytes.error().line();
  };
  EXPECT_EQ(read("Textures/Old%20Wood.PNG", 0), "wood");
  EXPECT_EQ(read("./Textures/Old Wood.PNG", 0), "wood");
  EXPECT_EQ(read("Textures\\Old Wood.PNG", 1), "wood");
  EXPECT_EQ(read("Textures%5COld%20Wood.PNG", 1), "wood");
  EXPECT_EQ(read("textures/old%20wood.png", 1), "wood");
  EXPECT_EQ(read("Textures/Old%2520Wood.PNG", 1), "wood");
  EXPECT_EQ(read("100%.png", 0), "percent");
  EXPECT_EQ(read("a%20b.png", 1), "raw");
  EXPECT_NE(read("Textures/none.png", 0).find("no such file"), std::string::npos);
  EXPECT_NE(read("..\\outside.png", 0).find("image 0"), std::string::npos);
}

TEST(Uri, OfDataIsReadInLettersOfAnyCaseAndBothAlphabets) {
  std::vector<std::string> warnings;
  for (const char* uri :
       {"data:;base64,+/8A", "DATA:image/png;BASE64,+/8A", "data:;charset=utf-8;Base64,-_8A",
        "data:;base64,%2B%2F8A", "data:;base64,+/\n8A"}) {
    const auto bytes = readUri("scene.gltf", uri, {}, "buffer 0", warnings);
    EXPECT_EQ(bytes, (std::vector<std::byte>{std::byte{0xfb}, std::byte{0xff}, std::byte{0}})) << uri;
  }
  EXPECT_THROW(readUri("scene.gltf", "data:;base64,*", {}, "buffer 0", warnings), Error);
}

}  // namespace
}  // namespace lambent::baker
