#include "baker/plan/group_lights.hpp"

#include <algorithm>

#include "baker/plan/lamp_spheres.hpp"

namespace lambent::baker {

std::int32_t groupRootOf(const Scene& scene, std::uint32_t node) {
  auto at = static_cast<std::int32_t>(node);
  while (at >= 0) {
    const gltf::Node& here = scene.nodes[static_cast<std::size_t>(at)];
    if (startsRigidGroup(here)) return at;
    at = here.parent;
  }
  return -1;
}

namespace {

bool isLit(glm::vec3 color) {
  return color.r > 0.0f || color.g > 0.0f || color.b > 0.0f;
}

}  // namespace

std::vector<PlannedLight> findGroupLights(const Scene& scene, const RigidGroup& group) {
  std::vector<PlannedLight> lights;
  for (const PlannedDraw& draw : group.draws) {
    const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
    if (material < 0) continue;
    const auto index = static_cast<std::uint32_t>(material);
    const gltf::Material& source = scene.materials[index];
    const bool known = std::any_of(lights.begin(), lights.end(),
                                   [&](const PlannedLight& light) { return light.index == index; });
    // Blended surfaces cast no shadow and rays miss them, so their light is only visible directly.
    if (!known && !source.unlit && source.alpha_mode != gltf::AlphaMode::Blend && isLit(source.emissive))
      lights.push_back({PlannedLight::Kind::Material, index, source.emissive, glm::mat4(1.0f),
                        findLampSpheres(scene, group, index)});
  }
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].light < 0 || groupRootOf(scene, n) != group.root) continue;
    const gltf::Light& light = scene.lights[static_cast<std::size_t>(scene.nodes[n].light)];
    const glm::vec3 color = light.intensity * light.color;
    if (!isLit(color) || light.type == gltf::Light::Type::Directional) continue;
    lights.push_back({PlannedLight::Kind::Node, n, color, groupFromNode(scene, group, n, world), {}});
  }
  return lights;
}

std::vector<bool> shadedPerPixel(std::span<const PlannedLight> lights) {
  // runtime/lighting/local_light.hpp has so many.
  constexpr std::ptrdiff_t kShadowCubes = 8;
  std::vector<bool> shaded;
  for (const PlannedLight& light : lights)
    shaded.push_back(light.kind == PlannedLight::Kind::Node || !light.spheres.empty());
  if (std::ranges::count(shaded, true) > kShadowCubes) shaded.assign(lights.size(), false);
  return shaded;
}

}  // namespace lambent::baker
