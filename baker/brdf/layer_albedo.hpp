// Holds how much of uniform light the specular layer of a smooth dielectric reflects towards a view: its
// directional albedo, 0..1, in the channel where that is largest. The layer is as rough as the material's
// factor says, without textures. Allocates nothing.
#pragma once

#include <array>
#include <cstddef>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/gltf_types.hpp"

namespace lambent::baker {

class LayerAlbedo {
 public:
  LayerAlbedo() = default;  // reflects nothing
  // `table` is that of isotropic GGX.
  LayerAlbedo(const bundle::BrdfTable& table, const gltf::Material& material);

  // Returns the albedo towards a view at an angle to the normal with this cosine.
  float towards(float cosine) const;

 private:
  static constexpr std::size_t kCosines = 65;  // evenly from 0 to 1
  std::array<float, kCosines> albedos_{};
};

}  // namespace lambent::baker
