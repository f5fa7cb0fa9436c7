// A Document is a checked glTF file with its buffers in memory: its container is opened, its JSON parsed,
// mended and checked (check.hpp), and its buffers are loaded. Images stay encoded. All conversions in this
// room read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "baker/import/scene_files.hpp"

namespace lambent::baker {

struct Document {
  std::filesystem::path path;
  ImportOptions options;
  nlohmann::json json;
  std::vector<std::vector<std::byte>> buffers;  // as many bytes as each announces
  std::vector<std::string> warnings;            // what was mended, one sentence each

  // Throws the Errors of importScene() that concern the file and not its geometry.
  Document(std::filesystem::path path, const ImportOptions& options);

  std::string file() const { return path.string(); }
  // Returns a top-level list, empty if it is absent.
  const nlohmann::json& list(const char* key) const {
    static const nlohmann::json kEmpty = nlohmann::json::array();
    const auto found = json.find(key);
    return found == json.end() ? kEmpty : *found;
  }
  const nlohmann::json& at(const char* key, std::size_t index) const { return json.at(key).at(index); }
  // Returns the bytes of a bufferView.
  std::span<const std::byte> view(std::size_t index) const {
    const nlohmann::json& view = at("bufferViews", index);
    return std::span(buffers[view.at("buffer").get<std::size_t>()])
        .subspan(view.value("byteOffset", std::size_t{0}), view.at("byteLength").get<std::size_t>());
  }
};

// Reads a member, if it is there: a number, or a list of numbers as a vector.
template <typename T>
void readMember(const nlohmann::json& object, const char* key, T& field) {
  const auto found = object.find(key);
  if (found == object.end()) return;
  if constexpr (requires { T::length(); })
    for (int c = 0; c < T::length(); ++c)
      field[c] = found->at(static_cast<std::size_t>(c)).template get<typename T::value_type>();
  else
    found->get_to(field);
}

// Reads accessors of a checked document as floats or indices: plain, interleaved, normalised, sparse, or
// without a bufferView (zeros). Integers become what glTF says: value / max if normalised, else the value
// itself.

// Holds a scalar, vector or 4 x 4 matrix per element, with `components` floats each.
struct Floats {
  std::vector<float> values;
  std::size_t components = 0;
  std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};
// Reads an accessor of one of these types ("VEC3"), into as many components as asked for (0: as stored);
// components that the file lacks (VEC3 colours in a VEC4) are 1. Errors name the accessor and `use`
// ("POSITION").
Floats readFloats(const Document& document, std::size_t accessor, const std::string& use,
                  std::initializer_list<std::string_view> types, std::size_t components = 0);

// Reads an index accessor, sparse or not.
std::vector<std::uint32_t> readIndices(const Document& document, std::size_t accessor);

}  // namespace lambent::baker
