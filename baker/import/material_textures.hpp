// Takes over textures and images of a document when the first material uses them. Only this room includes
// this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
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

  // Returns a texture reference of a material, without a texture if none is usable, which is a warning. `use`
  // names it there.
  gltf::TextureRef refer(int index, const tinygltf::ExtensionMap& extensions, int texcoord,
                         std::size_t material, const char* use);
  // Does the same for the textureInfo `key` of an extension.
  gltf::TextureRef refer(const tinygltf::Value& extension, const char* key, std::size_t material,
                         const char* use);
  // Returns the reference with the texture of roughness in place of that of glossiness, which is in its
  // alpha.
  gltf::TextureRef roughnessOf(gltf::TextureRef glossiness, float factor);

  // Returns whether an image could not be read.
  bool lacksImages() const { return lacks_images_; }

 private:
  static constexpr std::int32_t kUnknown = -2;

  // Returns the scene's texture for the file's, or -1 if it has no usable image.
  std::int32_t take(int index);
  std::int32_t takeImage(std::size_t index);
  Result<SceneImage> readImage(std::size_t index);
  Result<std::vector<std::byte>> imageBytes(const nlohmann::json& source, const std::string& object);

  const Document& document_;
  Scene& scene_;
  std::vector<std::int32_t> texture_of_, image_of_;
  bool lacks_images_ = false;
  std::map<std::pair<std::int32_t, float>, std::int32_t> roughness_of_;  // by texture and factor
};

}  // namespace lambent::baker
