// Writes small glTF files for the importer's tests, from one-triangle scenes as JSON, which each test
// modifies.
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "baker/import/gltf.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::testing {

// A PNG of one gray texel, as a file and as a URI.
inline const std::string kPngFile(
    "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\b\0\0\0\0:~"
    "\x9bU\0\0\0\nIDATx\x9c\x63h\0\0\0\x82\0\x81w\xcdr\xb6\0\0\0\0"
    "IEND\xae\x42`\x82",
    67);
inline constexpr const char* kPngUri =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg==";

// Builds a document: add() appends values to buffer 0 and returns the index of their accessor.
class GltfWriter {
 public:
  nlohmann::json json =
      nlohmann::json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0}],"accessors":[],"bufferViews":[],
    "meshes":[{"primitives":[{"attributes":{}}]}]})");
  std::string bytes;

  template <typename T>
  int add(const std::string& type, int component_type, const std::vector<T>& values, std::size_t components) {
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", values.size() / components},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }
  void addPositions(const std::vector<float>& xyz) {
    primitive()["attributes"]["POSITION"] = add("VEC3", 5126, xyz, 3);
  }

  // Writes the JSON as text and the buffer as a file beside it.
  std::filesystem::path writeText(const TemporaryFolder& folder,
                                  const std::string& buffer_name = "scene.bin") {
    json["buffers"] = {{{"byteLength", bytes.size()}, {"uri", buffer_name}}};
    if (buffer_name.find(':') == std::string::npos && buffer_name.find("..") == std::string::npos)
      folder.write(buffer_name, bytes);
    return folder.write("scene.gltf", json.dump());
  }

  std::string binary() {
    json["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto u32 = [](std::size_t v) {
      const auto value = static_cast<std::uint32_t>(v);
      return std::string(reinterpret_cast<const char*>(&value), 4);
    };
    return "glTF" + u32(2) + u32(28 + text.size() + bytes.size()) + u32(text.size()) + "JSON" + text +
           u32(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
  std::filesystem::path writeBinary(const TemporaryFolder& folder) {
    return folder.write("scene.glb", binary());
  }
};

// Sets parts of a document, by JSON pointer and value, or removes them where the value is empty. Arrays and
// objects on the way are made.
using Edits = std::vector<std::pair<std::string, std::string>>;
inline void edit(nlohmann::json& document, const Edits& edits) {
  for (const auto& [path, value] : edits)
    if (const nlohmann::json::json_pointer at(path); !value.empty())
      document[at] = nlohmann::json::parse(value);
    else
      document[at.parent_pointer()].erase(at.back());
}

// Makes the triangle (0,0,0) (1,0,0) (0,1,0).
inline GltfWriter oneTriangle() {
  GltfWriter writer;
  writer.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  return writer;
}

inline baker::Scene imported(const std::filesystem::path& path) {
  auto scene = baker::importScene(path);
  EXPECT_TRUE(scene) << (scene ? "" : scene.error().line());
  return scene ? std::move(*scene) : baker::Scene{};
}
inline baker::Scene imported(GltfWriter writer, const TemporaryFolder& folder) {
  return imported(writer.writeText(folder));
}

// Returns why the importer refuses the document.
inline std::string refusal(GltfWriter writer, const TemporaryFolder& folder) {
  const auto scene = baker::importScene(writer.writeText(folder));
  EXPECT_FALSE(scene);
  return scene ? "" : scene.error().line();
}

}  // namespace lambent::testing
