// Converts a bundle's material to the component that holds its live values, and applies a changed component
// to the material. Textures, double_sided and the alpha mode stay as they were baked. NaN or a value outside
// its field's range changes nothing.
#pragma once

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {

MaterialComponent materialComponent(const gltf::Material& baked, std::uint32_t bundle,
                                    std::uint32_t material);
gltf::Material withComponent(const gltf::Material& baked, const MaterialComponent& component);

}  // namespace lambent::scene
