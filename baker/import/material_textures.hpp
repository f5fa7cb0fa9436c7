// Takes over textures and images of a document when the first material uses them. Only this room includes
// this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/import/document.hpp"
#include "baker/import/scene.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {

// Returns number `key` of an extension, or `fallback` if it has none.
float numberOr(const tinygltf::Value& object, const char* key, float fallback);

class MaterialTextures {
 public:
  MaterialTextures(const Document& document, Scene& scene);

  // Returns a texture reference of a material, without a texture if none is usable. `use` names it in
  // warnings.
  Result<gltf::TextureRef> refer(int index, const tinygltf::ExtensionMap& extensions, int texcoord,
                                 std::size_t material, const char* use);
  // Does the same for the textureInfo `key` of an extension.
  Result<gltf::TextureRef> refer(const tinygltf::Value& extension, const char* key, std::size_t material,
                                 const char* use);

 private:
  static constexpr std::int32_t kUnknown = -2;

  // Returns the scene's texture for the file's, or -1 if it has no usable image.
  Result<std::int32_t> take(int index);
  Result<std::int32_t> takeImage(int index);
  Result<std::vector<std::byte>> imageBytes(const nlohmann::json& source, int index) const;

  const Document& document_;
  Scene& scene_;
  std::vector<std::int32_t> texture_of_, image_of_;
};

}  // namespace lambent::baker
