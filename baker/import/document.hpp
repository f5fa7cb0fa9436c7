// A checked glTF document with its buffers in memory: container opened, JSON parsed and checked (check.hpp),
// parsed into tinygltf's structures, buffers loaded. Images stay encoded. What the conversions in this room
// share: the document, the file's name for errors, and the list of warnings.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent_tinygltf {
class Model;
}

namespace lambent::baker {

// tinygltf refuses index accessors without a bufferView, which Draco primitives have; their number is kept
// here, in the extension object, instead.
inline constexpr const char* kDracoIndices = "lambent_indices";

class Document {
 public:
  // Errors: those of importScene() that concern the file, not its geometry.
  static Result<Document> open(const std::filesystem::path& path);

  Document(Document&&) noexcept;
  Document& operator=(Document&&) noexcept;
  ~Document();

  const lambent_tinygltf::Model& model() const { return *model_; }
  const std::filesystem::path& path() const { return path_; }
  std::string file() const { return path_.string(); }

 private:
  Document(std::filesystem::path path, std::unique_ptr<lambent_tinygltf::Model> model);
  std::filesystem::path path_;
  std::unique_ptr<lambent_tinygltf::Model> model_;
};

}  // namespace lambent::baker
