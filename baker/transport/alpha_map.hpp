// Says where cut-out surfaces (alphaMode MASK) let rays through: texture, factor and vertex colour are
// compared with the cutoff.
#pragma once

#include <memory>
#include <vector>

#include <glm/vec2.hpp>

#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"

namespace lambent::baker {

struct AlphaMap {
  std::shared_ptr<const DecodedImage> image;  // null if there is none: only factor and vertex alpha count
  gltf::Sampler sampler;
  float factor = 1.0f;
  float cutoff = 0.5f;

  // Returns whether a surface point with this texture coordinate and vertex alpha stops a ray.
  bool blocks(glm::vec2 uv, float vertex_alpha) const {
    const float texture_alpha = image ? sampleImage(*image, sampler, uv).w : 1.0f;
    return texture_alpha * factor * vertex_alpha >= cutoff;
  }
};

// There is one entry per material, null if its alpha mode is not MASK.
using AlphaMaps = std::vector<std::shared_ptr<const AlphaMap>>;
Result<AlphaMaps> loadAlphaMaps(const Scene& scene, DecodedImages& images);

}  // namespace lambent::baker
