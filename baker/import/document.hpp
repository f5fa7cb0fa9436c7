// A Document is a checked glTF file with its buffers in memory: its container is opened, its JSON parsed and
// checked (check.hpp) and read into tinygltf's structures, and its buffers are loaded. Images stay encoded.
// All conversions in this room read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "baker/import/scene_files.hpp"
#include "runtime/base/result.hpp"

namespace lambent_tinygltf {
class Model;
}

namespace lambent::baker {

// tinygltf refuses index accessors without a bufferView, which Draco primitives have and sparse ones may
// have. Their number is kept in this extension object of the primitive instead.
inline constexpr const char* kIndicesAside = "LAMBENT_indices";

class Document {
 public:
  // Errors: those of importScene() that concern the file and not its geometry.
  static Result<Document> open(const std::filesystem::path& path, const ImportOptions& options = {});

  Document(Document&&) noexcept;
  Document& operator=(Document&&) noexcept;
  ~Document();

  const lambent_tinygltf::Model& model() const { return *model_; }
  // Returns the checked JSON, without buffers and images, for the parts that tinygltf does not read
  // faithfully (extensions, animations, skins).
  const nlohmann::json& json() const { return *json_; }
  // Lists what was mended, one sentence each.
  const std::vector<std::string>& warnings() const { return warnings_; }
  const ImportOptions& options() const { return options_; }
  const std::filesystem::path& path() const { return path_; }
  std::string file() const { return path_.string(); }

 private:
  Document(std::filesystem::path path, const ImportOptions& options,
           std::unique_ptr<lambent_tinygltf::Model> model, std::unique_ptr<nlohmann::json> json,
           std::vector<std::string> warnings);
  std::filesystem::path path_;
  ImportOptions options_;
  std::unique_ptr<lambent_tinygltf::Model> model_;
  std::unique_ptr<nlohmann::json> json_;
  std::vector<std::string> warnings_;
};

// Reads accessors of a checked document as floats or indices: plain, interleaved, normalised, sparse, or
// without a bufferView (zeros). Integers become what glTF says: value / max if normalised, else the value
// itself.

// Holds a scalar, vector or 4 x 4 matrix per element, with `components` floats each; components that the file
// lacks (VEC3 colours in a VEC4) are 1. Errors name the accessor and `use` ("POSITION").
struct Floats {
  std::vector<float> values;
  std::size_t components = 0;
  std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};
Result<Floats> readFloats(const Document& document, int accessor, const std::string& use,
                          const std::vector<int>& allowed_components, std::size_t components);

// Reads an index accessor, sparse or not.
Result<std::vector<std::uint32_t>> readIndices(const Document& document, int accessor);

}  // namespace lambent::baker
