// Tests what importScene() reads with one warning that names the part: files that are odd or slightly broken,
// as common exporters write them and common viewers show them.

#include <gtest/gtest.h>

#include "baker/import/gltf.hpp"
#include "baker/import/image.hpp"
#include "tests/baker/import/gltf_writer.hpp"
#include "tests/support/require.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;
using testing::GltfWriter;
using testing::imported;
using testing::oneTriangle;
using testing::TemporaryFolder;

std::string withLight(const char* light) {
  return std::string(R"({"KHR_lights_punctual":{"lights":[)") + light + "]}}";
}
std::string withCamera(const char* lens) {
  return std::string(R"([{"type":"perspective","perspective":)") + lens + "}]";
}

TEST(OddScene, IsReadWithOneWarningThatNamesThePart) {
  struct Case {
    const char* names;  // which the warning must contain
    testing::Edits edits;
  };
  const std::vector<Case> cases{
      {"bufferView 0: byteStride is 0", {{"/bufferViews/0/byteStride", "0"}}},
      {"bufferView 1 has no bytes", {{"/bufferViews/1", R"({"buffer":0,"byteLength":0})"}}},
      {"bufferView 1 reaches from", {{"/bufferViews/1", R"({"buffer":0,"byteLength":1000})"}}},
      {"accessor 1 has an unknown componentType",  // a double, which only an attribute of the author's uses
       {{"/accessors/1", R"({"bufferView":0,"componentType":5130,"count":3,"type":"SCALAR"})"},
        {"/meshes/0/primitives/0/attributes/_MEASURED", "1"}}},
      {"mesh 0, primitive 1: has no geometry",
       {{"/accessors/1", R"({"componentType":5126,"count":0,"type":"VEC3","min":[null,null,null]})"},
        {"/meshes/0/primitives/1", R"({"attributes":{"POSITION":1}})"}}},
      {"mesh 0, primitive 1: has no geometry",
       {{"/accessors/1", R"({"componentType":5125,"count":0,"type":"SCALAR"})"},
        {"/meshes/0/primitives/1", R"({"attributes":{"POSITION":0},"indices":1})"}}},
      {"primitive 1: has no geometry", {{"/meshes/0/primitives/1", "{}"}}},
      {"mesh 0, primitive 0: NORMAL has 2 elements",
       {{"/accessors/1", R"({"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"})"},
        {"/meshes/0/primitives/0/attributes/NORMAL", "1"}}},
      {"TEXCOORD_0 has 3 elements of \"VEC3\"", {{"/meshes/0/primitives/0/attributes/TEXCOORD_0", "0"}}},
      {"accessor 0: sparse replaces nothing", {{"/accessors/0/sparse", R"({"count":0})"}}},
      {"meshes 0 primitives 0: material is null", {{"/meshes/0/primitives/0/material", "null"}}},
      {"nodes 0: skin is -1", {{"/nodes/0/skin", "-1"}}},
      {"nodes 0: name is not a string", {{"/nodes/0/name", "7"}}},
      {"camera 0: perspective: znear is 0", {{"/cameras", withCamera(R"({"yfov":1,"znear":0})")}}},
      {"camera 0: perspective: zfar is 0.5",
       {{"/cameras", withCamera(R"({"yfov":1,"znear":1,"zfar":0.5})")}}},
      {"camera 0: perspective: yfov is 4", {{"/cameras", withCamera(R"({"yfov":4,"znear":1})")}}},
      {"camera 0: perspective: aspectRatio is 0",
       {{"/cameras", withCamera(R"({"yfov":1,"znear":1,"aspectRatio":0})")}}},
      {"camera 0: its type is not known", {{"/cameras", R"([{"perspective":{"yfov":1,"znear":1}}])"}}},
      {"animation 0: channel 0 has no target",
       {{"/animations", R"([{"channels":[{"sampler":0}],"samplers":[]}])"}}},
      {"animation 0: channel 0 has no sampler",
       {{"/animations", R"([{"channels":[{"target":{"node":5}}]}])"}}},
      {"animation 0, sampler 0: interpolation",
       {{"/animations", R"([{"samplers":[{"input":0,"output":0,"interpolation":"MAGIC"}]}])"}}},
      {"light 0: its type \"laser\"", {{"/extensions", withLight(R"({"type":"laser"})")}}},
      {"light 0: intensity is -1", {{"/extensions", withLight(R"({"type":"point","intensity":-1})")}}},
      {"light 0: intensity is 3e+38",
       {{"/extensions", withLight(R"({"type":"point","color":[1,0.5,1],"intensity":3e38})")}}},
      {"light 0: range is -1", {{"/extensions", withLight(R"({"type":"point","range":-1})")}}},
      {"light 0: range is 0", {{"/extensions", withLight(R"({"type":"point","range":0})")}}},
      {"lights 0: range is null", {{"/extensions", withLight(R"({"type":"point","range":null})")}}},
      {"light 0: color is [1,-1,0]", {{"/extensions", withLight(R"({"type":"point","color":[1,-1,0]})")}}},
      {"light 0: it has no spot", {{"/extensions", withLight(R"({"type":"spot"})")}}},
      {"light 0: spot: innerConeAngle",
       {{"/extensions", withLight(R"({"type":"spot","spot":{"innerConeAngle":0.5,"outerConeAngle":0.4}})")}}},
      {"light 0: spot: outerConeAngle is 3",
       {{"/extensions", withLight(R"({"type":"spot","spot":{"outerConeAngle":3.0}})")}}},
      {"material 0: extensions: KHR_materials_emissive_strength: emissiveStrength is -1",
       {{"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", "-1"}}},
      {"emissiveStrength is 3e+38",
       {{"/materials/0/emissiveFactor", "[1,1,1]"},
        {"/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", "3e38"}}},
      {"material 0: emissiveFactor is [1,-1,1]", {{"/materials/0/emissiveFactor", "[1,-1,1]"}}},
      {"KHR_texture_transform: scale is not 2 finite numbers",
       {{"/images/0/uri", std::string("\"") + testing::kPngUri + "\""},
        {"/textures/0/source", "0"},
        {"/materials/0/normalTexture",
         R"({"index":0,"extensions":{"KHR_texture_transform":{"scale":[1]}}})"}}},
      {"sampler 0: wrapS is 33069, which counts as 33071", {{"/samplers/0/wrapS", "33069"}}},
      {"sampler 0: magFilter is 9987", {{"/samplers/0/magFilter", "9987"}}},
  };
  TemporaryFolder folder;
  for (const Case& odd : cases) {
    SCOPED_TRACE(odd.names);
    GltfWriter writer = oneTriangle();
    writer.writeText(folder);
    testing::edit(writer.json, odd.edits);
    const Scene scene = imported(folder.write("scene.gltf", writer.json.dump()));
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].primitives.size(), 1u);
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings.at(0).find(odd.names), std::string::npos) << scene.warnings[0];
  }
}

TEST(OddScene, OfDialectsOfJsonIsReadWithoutAWord) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["accessors"][0]["count"] = 3.0;
  writer.json["accessors"][0]["max"] = {nullptr, "no", 3};
  writer.json["nodes"][0]["extensions"] = json::array();  // how PHP writes an empty object
  writer.json["nodes"][0]["extras"] = {{"anything", nullptr}};
  writer.json["meshes"][0]["extras"] = nullptr;
  writer.writeText(folder);
  writer.json["buffers"].push_back({{"byteLength", 0}});
  EXPECT_TRUE(imported(folder.write("scene.gltf", writer.json.dump())).warnings.empty());
}

TEST(OddScene, HasNamesInLatin1) {
  TemporaryFolder folder;
  GltfWriter writer = oneTriangle();
  writer.json["nodes"][0]["name"] = "K?che";
  writer.writeText(folder);
  std::string text = writer.json.dump();
  text[text.find('?')] = '\xfc';
  const Scene scene = imported(folder.write("scene.gltf", text));
  EXPECT_EQ(scene.nodes.at(0).name,
            "K\xc3\xbc"
            "che");
  EXPECT_EQ(scene.warnings.size(), 1u);
}

// Makes a triangle whose base color is texture 0.
GltfWriter textured(const json& texture, const json& images) {
  GltfWriter writer = oneTriangle();
  writer.primitive()["material"] = 0;
  writer.json["materials"] = json::parse(R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])");
  writer.json["textures"] = json::array({texture});
  writer.json["images"] = images;
  return writer;
}

TEST(OddScene, IsAsWithoutATextureThatCannotBeRead) {
  TemporaryFolder folder;
  folder.write("empty.png", "");
  folder.write("cut.png", testing::kPngFile.substr(0, 50));
  folder.write("page.png", "<html>404</html>");
  folder.write("basis.ktx2", "\xabKTX 20\xbb\r\n\x1a\n and so on");
  const std::tuple<json, const char*> cases[] = {
      {{{"uri", "none.png"}}, "none.png"},
      {{{"uri", "empty.png"}}, "empty.png"},
      {{{"uri", "cut.png"}}, "is truncated"},
      {{{"uri", "page.png"}}, "neither PNG"},
      {{{"uri", "basis.ktx2"}}, "gltf-transform ktxdecompress"},
      {{{"uri", "http://example.com/a.png"}}, "not a file beside the scene"},
      {{{"uri", "../a.png"}}, "--allow-outside"},
      {{{"uri", "data:image/png;base64,!"}}, "not base64"},
      {json::object(), "names neither"},
  };
  for (const auto& [image, words] : cases) {
    const Scene scene = imported(textured({{"source", 0}}, json::array({image})), folder);
    ASSERT_EQ(scene.warnings.size(), 1u) << words;
    EXPECT_TRUE(scene.warnings[0].starts_with("image 0")) << scene.warnings[0];
    EXPECT_NE(scene.warnings[0].find(words), std::string::npos) << scene.warnings[0];
    EXPECT_TRUE(scene.images.empty());
    EXPECT_EQ(scene.materials.at(0).base_color_texture.texture, -1);
  }
}

TEST(OddScene, ReadsWebpAndKeepsItAsPng) {
  TemporaryFolder folder;
  const json webp = {
      {"uri", "data:image/webp;base64,UklGRigAAABXRUJQVlA4TBwAAAAvD8ADAA8wZJexvBry/EcLxIJJ/tKdU4jof8YJ"}};
  GltfWriter writer =
      textured({{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}, json::array({webp}));
  writer.json["extensionsUsed"] = writer.json["extensionsRequired"] = {"EXT_texture_webp"};
  const Scene scene = imported(writer, folder);
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].mime_type, "image/png");
  const auto decoded = decodeImage(scene.images[0]);
  ASSERT_TRUE(decoded) << decoded.error().line();
  EXPECT_EQ(decoded->width, 16u);
}

TEST(OddScene, UsesTheImageThatCanBeReadOfATextureWithTwo) {
  TemporaryFolder folder;
  folder.write("basis.ktx2", "\xabKTX 20\xbb\r\n\x1a\n and so on");
  const json images = json::array({{{"uri", testing::kPngUri}}, {{"uri", "basis.ktx2"}}});
  GltfWriter writer =
      textured({{"source", 0}, {"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}}, images);
  writer.json["extensionsUsed"] = {"KHR_texture_basisu"};
  const Scene scene = imported(writer, folder);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.images.size(), 1u);
}

TEST(OddScene, HasColorsAsSharesWhetherOrNotTheyAreFlagged) {
  TemporaryFolder folder;
  for (const bool flagged : {true, false}) {
    GltfWriter writer = oneTriangle();
    writer.primitive()["attributes"]["COLOR_0"] =
        writer.add<std::uint8_t>("VEC4", 5121, {51, 0, 0, 255, 51, 0, 0, 255, 51, 0, 0, 255}, 4);
    if (flagged) writer.json["accessors"].back()["normalized"] = true;
    const Scene scene = imported(writer, folder);
    EXPECT_EQ(scene.meshes.at(0).primitives.at(0).mesh.colors.at(0), glm::vec4(0.2f, 0.0f, 0.0f, 1.0f));
    ASSERT_EQ(scene.warnings.size(), flagged ? 0u : 1u);
  }
}

TEST(OddScene, KeepsSmallTrianglesOfALargeMesh) {
  TemporaryFolder folder;
  GltfWriter writer;
  // A ground of 10 km, a triangle of 1 mm, one of a micrometre, and one whose corners lie on a line up to
  // rounding.
  writer.addPositions({-5e3f,  0,     -5e3f, 5e3f, 0,      -5e3f, 0,    0,    5e3f, 3,     1,    2,
                       3.001f, 1,     2,     3,    1.001f, 2,     0,    0,    0,    1e-6f, 0,    0,
                       0,      1e-6f, 0,     0.1f, 0.1f,   0.1f,  0.2f, 0.2f, 0.2f, 0.7f,  0.7f, 0.7f});
  const Scene scene = imported(writer, folder);
  EXPECT_EQ(scene.meshes.at(0).primitives.at(0).mesh.indices.size(), 9u);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(OddScene, OfTheFoundFilesIsReadWithOneWarning) {
  const auto folder = testing::sharedFile("found");
  LAMBENT_NEEDS_SHARED(folder);
  const std::pair<const char*, const char*> files[] = {{"backslash.gltf", "image 0"},
                                                       {"empty_geometry.glb", "mesh 2, primitive 0"},
                                                       {"missing_texture.gltf", "wood.png"},
                                                       {"range0.glb", "light 0: range"},
                                                       {"stride0.glb", "bufferView 0: byteStride"},
                                                       {"zero_view_unused.glb", "bufferView 8"},
                                                       {"znear0.glb", "camera 0"}};
  for (const auto& [file, words] : files) {
    const Scene scene = imported(folder / "lenient-import" / file);
    ASSERT_EQ(scene.warnings.size(), 1u) << file;
    EXPECT_NE(scene.warnings[0].find(words), std::string::npos) << scene.warnings[0];
  }
  EXPECT_TRUE(imported(folder / "lenient-import/upper.gltf").warnings.empty());
  const Scene joined = imported(folder / "joined-mesh-drops-small-triangles/joined.glb");
  std::size_t corners = 0;  // of the ground and, as a primitive of its own, the ball
  for (const ScenePrimitive& primitive : joined.meshes.at(0).primitives)
    corners += primitive.mesh.indices.size();
  EXPECT_EQ(joined.meshes.at(0).primitives.size(), 2u);
  EXPECT_EQ(corners, 3u * 9026);
}

}  // namespace
}  // namespace lambent::baker
