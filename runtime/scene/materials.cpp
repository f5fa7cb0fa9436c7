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
  return {gltf::factorsOf(baked), bundle, material};
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
  return gltf::withFactors(baked, now);
}

}  // namespace lambent::scene
