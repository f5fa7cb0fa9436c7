// Materials as components: what of a bundle's material may be changed while it is shown. Comes in: a material
// as the bundle has it. Goes out: the component that says the same, and the material as a component has
// changed it. Textures, sidedness and how alpha counts stay as they were baked. A number that is none, or
// outside its field's range, changes nothing.
#pragma once

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::scene {

MaterialComponent materialComponent(const gltf::Material& baked, std::uint32_t bundle,
                                    std::uint32_t material);
gltf::Material withComponent(const gltf::Material& baked, const MaterialComponent& component);

}  // namespace lambent::scene
