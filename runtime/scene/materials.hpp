// Declares the component that holds the live values of a bundle's material, in a header of its own because
// the table of fields takes compilers long.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>

#include "runtime/bundle/material_fields.hpp"
#include "runtime/ecs/fields.hpp"

namespace lambent::scene {

// Describes a material of a bundle, which is an entity of its own. Its factors shade surfaces; textures and
// vertex colours multiply them. A change shows in the next frame, except for baked effects
// (world/material_rebake.hpp tells which). The radiance of a LampComponent takes precedence over `emission`.
struct MaterialComponent : gltf::MaterialFactors {
  std::uint32_t bundle = 0, material = 0;

  static constexpr std::string_view kComponentName = "Material";
  // Returns the live values in the table of material fields, in its order.
  static auto fields() {
    return std::apply(
        [](const auto&... row) {
          return std::tuple_cat(
              std::apply([](const auto&... live) { return std::tuple{fieldOf(live)...}; }, row.live)...);
        },
        gltf::kMaterialFields);
  }

 private:
  template <class T>
  static ecs::Field<MaterialComponent, T> fieldOf(const gltf::LiveValue<T>& live) {
    std::optional<ecs::Range<T>> range;
    if (live.range) range = {live.range->least, live.range->greatest};
    return {live.name, live.factor, gltf::MaterialFactors().*live.factor, live.unit, range};
  }
};

// Converts a bundle's material to its component, and applies a changed component to the material. Textures,
// double_sided and the alpha mode stay as they were baked. NaN or a value outside its field's range changes
// nothing.
MaterialComponent materialComponent(const gltf::Material& baked, std::uint32_t bundle,
                                    std::uint32_t material);
gltf::Material withComponent(const gltf::Material& baked, const MaterialComponent& component);

}  // namespace lambent::scene
