// Samples textures for rays: bilinear at full resolution with the sampler's wrap modes, from the decoded
// images. Colours are returned linear, data (normals) as stored. Texel centres are at half-integers, and v =
// 0 is the top.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "baker/import/image.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

class Textures {
 public:
  // Decodes the images that materials of `scene` use. Errors name the image.
  static Result<Textures> load(const Scene& scene);

  // Returns the sRGB colour converted to linear, with alpha, or white if there is no such texture.
  glm::vec4 color(const gltf::TextureRef& ref, const glm::vec2& uv) const;
  // Returns the values as stored, 0..1.
  glm::vec4 data(const gltf::TextureRef& ref, const glm::vec2& uv) const;

 private:
  template <typename Decode>
  glm::vec4 lookUp(const gltf::TextureRef& ref, const glm::vec2& uv, const Decode& decode) const;

  std::vector<gltf::Texture> textures_;
  std::vector<std::optional<DecodedImage>> images_;
};

}  // namespace lambent::baker::reference
