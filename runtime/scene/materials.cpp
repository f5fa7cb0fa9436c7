#include "runtime/scene/materials.hpp"

#include <cmath>
#include <type_traits>

namespace lambent::scene {

namespace {

bool usable(const glm::vec3& value) {
  return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
}

}  // namespace

MaterialComponent materialComponent(const gltf::Material& baked, std::uint32_t bundle,
                                    std::uint32_t material) {
  return {.bundle = bundle,
          .material = material,
          .base_color = glm::vec3(baked.base_color),
          .alpha = baked.base_color.a,
          .metallic = baked.metallic,
          .roughness = baked.roughness,
          .ior = baked.ior,
          .specular = baked.specular,
          .specular_color = baked.specular_color,
          .anisotropy = baked.anisotropy,
          .anisotropy_rotation_rad = baked.anisotropy_rotation_rad,
          .brdf = baked.brdf,
          .emission = baked.emissive,
          .emission_strength = 1.0f,
          .normal_scale = baked.normal_scale,
          .alpha_cutoff = baked.alpha_cutoff};
}

gltf::Material withComponent(const gltf::Material& baked, const MaterialComponent& component) {
  MaterialComponent now = component;
  const MaterialComponent before = materialComponent(baked, component.bundle, component.material);
  ecs::forEachField(now, [&](const auto& field, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    bool good = ecs::withinRange(field, value);
    if constexpr (std::is_same_v<Value, glm::vec3>) good = usable(value);
    if constexpr (std::is_same_v<Value, float>) good = good && std::isfinite(value);
    if (!good) value = field.of(before);
  });
  gltf::Material material = baked;
  material.base_color = glm::vec4(now.base_color, now.alpha);
  material.metallic = now.metallic;
  material.roughness = now.roughness;
  material.ior = now.ior;
  material.specular = now.specular;
  material.specular_color = now.specular_color;
  material.anisotropy = now.anisotropy;
  material.anisotropy_rotation_rad = now.anisotropy_rotation_rad;
  material.brdf = now.brdf;
  material.emissive = now.emission_strength * now.emission;
  material.normal_scale = now.normal_scale;
  material.alpha_cutoff = now.alpha_cutoff;
  return material;
}

}  // namespace lambent::scene
