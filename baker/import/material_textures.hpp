// The textures and images of a document, taken over when the first material asks for them. In this room only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "baker/import/document.hpp"
#include "baker/import/scene.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {

// Number `key` of an extension, `fallback` where it has none.
float numberOr(const tinygltf::Value& object, const char* key, float fallback);

class MaterialTextures {
 public:
  MaterialTextures(const Document& document, Scene& scene);

  // The reference of a material, `use` in words; without a texture where it has none that can be used.
  Result<gltf::TextureRef> refer(int index, const tinygltf::ExtensionMap& extensions, int texcoord,
                                 std::size_t material, const char* use);
  // The same of the textureInfo `key` of an extension.
  Result<gltf::TextureRef> refer(const tinygltf::Value& extension, const char* key, std::size_t material,
                                 const char* use);

 private:
  static constexpr std::int32_t kUnknown = -2;

  // The scene's texture for the file's, -1 where it has no image that can be used.
  Result<std::int32_t> take(int index);
  Result<std::int32_t> takeImage(int index);
  Result<std::vector<std::byte>> imageBytes(const nlohmann::json& source, int index) const;

  const Document& document_;
  Scene& scene_;
  std::vector<std::int32_t> texture_of_, image_of_;
};

}  // namespace lambent::baker
