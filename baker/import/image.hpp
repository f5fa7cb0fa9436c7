// Decoded texture images for passes that look texels up (alpha masks, textured albedo, emission).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "baker/import/scene.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Four channels of 8 bits as stored (colour sRGB-coded, alpha linear), row 0 at the top (v = 0).
struct DecodedImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// By OpenImageIO. Errors name the image.
Result<DecodedImage> decodeImage(const SceneImage& image);

// The images of a scene, decoded when first asked for and then kept. For one thread.
class DecodedImages {
 public:
  explicit DecodedImages(const Scene& scene) : scene_(scene) {}  // outlives this

  // Of a texture of the scene; null where it has no image. Errors: those of decodeImage.
  Result<std::shared_ptr<const DecodedImage>> ofTexture(std::int32_t texture);

 private:
  const Scene& scene_;
  std::map<std::int32_t, std::shared_ptr<const DecodedImage>> images_;
};

// Bilinear look-up at uv under the sampler's wrap modes: linear RGB, alpha, each 0..1.
glm::vec4 sampleImage(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);

// The texel that uv falls in, for sums over so many look-ups that blending between texels makes no
// difference.
glm::vec4 nearestTexel(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);
// The same of a picture that holds no colours: all four channels 0..1 as stored.
glm::vec4 nearestData(const DecodedImage& image, const gltf::Sampler& sampler, glm::vec2 uv);

}  // namespace lambent::baker
