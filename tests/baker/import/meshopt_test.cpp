// Tests EXT_meshopt_compression: data survives a round trip, and invalid data is refused.
#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "baker/import/gltf.hpp"
#include "tests/baker/import/gltf_writer.hpp"
#include "tests/support/shapes.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// Makes a grid whose positions and indices are coded in "coded.bin"; buffer 1 has no bytes of its own.
struct CodedGrid {
  bundle::MeshData mesh = testing::grid({0, 0, 0}, 2.0f, 12);
  json document;
  std::string bytes;

  CodedGrid() {
    std::vector<unsigned char> vertices(
        meshopt_encodeVertexBufferBound(mesh.positions.size(), sizeof(glm::vec3)));
    vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), mesh.positions.data(),
                                               mesh.positions.size(), sizeof(glm::vec3)));
    std::vector<unsigned char> indices(
        meshopt_encodeIndexBufferBound(mesh.indices.size(), mesh.positions.size()));
    indices.resize(
        meshopt_encodeIndexBuffer(indices.data(), indices.size(), mesh.indices.data(), mesh.indices.size()));
    bytes.assign(vertices.begin(), vertices.end());
    bytes.append(indices.begin(), indices.end());

    const std::size_t position_bytes = mesh.positions.size() * sizeof(glm::vec3),
                      index_bytes = mesh.indices.size() * 4;
    const auto coded = [](std::size_t offset, std::size_t length, std::size_t stride, std::size_t count,
                          const char* mode) {
      return json{{"EXT_meshopt_compression",
                   {{"buffer", 0},
                    {"byteOffset", offset},
                    {"byteLength", length},
                    {"byteStride", stride},
                    {"count", count},
                    {"mode", mode}}}};
    };
    document = {
        {"asset", {{"version", "2.0"}}},
        {"extensionsUsed", {"EXT_meshopt_compression"}},
        {"extensionsRequired", {"EXT_meshopt_compression"}},
        {"scene", 0},
        {"scenes", json::array({{{"nodes", {0}}}})},
        {"nodes", json::array({{{"mesh", 0}}})},
        {"meshes",
         json::array({{{"primitives", json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}})}}})},
        {"accessors", json::array({{{"bufferView", 0},
                                    {"componentType", 5126},
                                    {"count", mesh.positions.size()},
                                    {"type", "VEC3"}},
                                   {{"bufferView", 1},
                                    {"componentType", 5125},
                                    {"count", mesh.indices.size()},
                                    {"type", "SCALAR"}}})},
        {"bufferViews",
         json::array({{{"buffer", 1},
                       {"byteOffset", 0},
                       {"byteLength", position_bytes},
                       {"byteStride", 12},
                       {"extensions", coded(0, vertices.size(), 12, mesh.positions.size(), "ATTRIBUTES")}},
                      {{"buffer", 1},
                       {"byteOffset", position_bytes},
                       {"byteLength", index_bytes},
                       {"extensions",
                        coded(vertices.size(), indices.size(), 4, mesh.indices.size(), "TRIANGLES")}}})},
        {"buffers", json::array({{{"uri", "coded.bin"}, {"byteLength", bytes.size()}},
                                 {{"byteLength", position_bytes + index_bytes},
                                  {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}})}};
  }

  Result<Scene> import() const {
    const testing::TemporaryFolder folder;
    folder.write("coded.bin", bytes);
    return importScene(folder.write("scene.gltf", document.dump()));
  }
  json& coded(std::size_t view) {
    return document["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
  }
};

TEST(Meshopt, GivesBackWhatWasCoded) {
  const CodedGrid grid;
  const auto scene = grid.import();
  ASSERT_TRUE(scene) << scene.error().line();
  const bundle::MeshData& mesh = scene->meshes[0].primitives[0].mesh;
  ASSERT_EQ(mesh.indices.size(), grid.mesh.indices.size());
  // Corners of a triangle may be permuted cyclically, and flat shading duplicates them, so sums over the
  // corners of triangles are compared.
  glm::vec3 low(1e9f), high(-1e9f);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    glm::vec3 expected(0.0f), found(0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      expected += grid.mesh.positions[grid.mesh.indices[i + c]];
      found += mesh.positions[mesh.indices[i + c]];
      low = glm::min(low, mesh.positions[mesh.indices[i + c]]);
      high = glm::max(high, mesh.positions[mesh.indices[i + c]]);
    }
    EXPECT_LT(glm::distance(expected, found), 1e-6f) << i;
    EXPECT_GT(mesh.normals[mesh.indices[i]].y, 0.99f);
  }
  EXPECT_EQ(low, glm::vec3(-1, 0, -1));
  EXPECT_EQ(high, glm::vec3(1, 0, 1));
}

TEST(Meshopt, RefusesWhatIsFalseByName) {
  const auto refused = [](const std::function<void(CodedGrid&)>& spoil, const char* what, const char* place) {
    CodedGrid grid;
    spoil(grid);
    const auto scene = grid.import();
    ASSERT_FALSE(scene) << what;
    EXPECT_NE(scene.error().problem.find(place), std::string::npos) << scene.error().line();
  };
  refused([](CodedGrid& g) { g.bytes[0] = 'x'; }, "not vertex data", "bufferView 0");
  refused([](CodedGrid& g) { g.coded(0)["byteLength"] = 20; }, "cut short", "bufferView 0");
  refused([](CodedGrid& g) { g.coded(0)["byteLength"] = 1 << 20; }, "past the buffer", "buffer 0");
  refused([](CodedGrid& g) { g.coded(0)["buffer"] = 2; }, "no such buffer", "buffer 2");
  refused([](CodedGrid& g) { g.coded(0)["count"] = 7; }, "another count", "7 elements");
  refused([](CodedGrid& g) { g.coded(0)["byteStride"] = 0; }, "no stride", "0 bytes");
  refused([](CodedGrid& g) { g.coded(0)["mode"] = "MAGIC"; }, "no such mode", "MAGIC");
  refused([](CodedGrid& g) { g.coded(0)["filter"] = "OCTAHEDRAL"; }, "stride of 12", "OCTAHEDRAL");
  refused([](CodedGrid& g) { g.coded(1)["mode"] = "ATTRIBUTES"; }, "indices as vertices", "bufferView 1");
  refused(
      [](CodedGrid& g) {
        // A few bytes claim to decode to three gigabytes.
        g.document["buffers"][1]["byteLength"] = 3000000000u;
      },
      "a bomb", "claims 3000000000 bytes");
  refused(
      [](CodedGrid& g) {
        // The same bytes referenced many times count only once.
        for (int i = 0; i < 100; ++i) g.document["bufferViews"].push_back(g.document["bufferViews"][0]);
        g.document["buffers"][1]["byteLength"] = (g.bytes.size() + 2) * 256;
      },
      "a bomb with many fuses", fmt::format("bytes coded in {}", CodedGrid().bytes.size()).c_str());
}

}  // namespace
}  // namespace lambent::baker
