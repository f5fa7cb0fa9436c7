// Decodes texture images for passes that look texels up (alpha masks, textured albedo, emission).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Holds four channels of 8 bits as stored (colour sRGB-coded, alpha linear), with row 0 at the top (v = 0).
struct DecodedImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// Decodes by OpenImageIO. Errors name the image.
Result<DecodedImage> decodeImage(const SceneImage& image);

// Makes images that bundles can keep: PNG or JPEG, whatever the file brings.

// Returns a PNG or JPEG as it is, and WebP, BMP, GIF, TIFF and TGA as PNG. Throws an Error if the image is of
// another kind, or cannot be decoded.
SceneImage storableImage(std::string name, std::vector<std::byte> bytes);

// Returns the metallic-roughness texture of KHR_materials_pbrSpecularGlossiness, whose images have glossiness
// in alpha: green is 1 - factor x glossiness, blue is 0. Throws an Error if it cannot be decoded.
SceneImage roughnessImage(const SceneImage& glossiness, float factor);

// Decodes the images of a scene when they are first asked for and keeps them. It must be used from one
// thread.
class DecodedImages {
 public:
  explicit DecodedImages(const Scene& scene) : scene_(scene) {}  // must outlive this

  // Returns the image of a texture of the scene, or null if it has none. Errors: those of decodeImage.
  Result<std::shared_ptr<const DecodedImage>> ofTexture(std::int32_t texture);

 private:
  const Scene& scene_;
  std::map<std::int32_t, std::shared_ptr<const DecodedImage>> images_;
};

// Returns a bilinear look-up at uv under the sampler's wrap modes: linear RGB and alpha, each 0..1.
glm::vec4 sampleImage(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);
// Does the same for an image that holds no colours: all four channels are 0..1 as stored.
glm::vec4 sampleData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);

// Returns the texel that contains uv, for sums over so many look-ups that blending between texels makes no
// difference.
glm::vec4 nearestTexel(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);
glm::vec4 nearestData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);

}  // namespace lambent::baker
