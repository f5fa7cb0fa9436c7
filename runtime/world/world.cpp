#include "runtime/world/world.hpp"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/scene/materials.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::frame {

namespace {

ecs::Entity lampOf(const bundle::Description& description, const scene::SceneInstance& instance,
                   const bundle::Draw& draw) {
  const std::int32_t material = description.meshes[draw.mesh].primitives[draw.primitive].material;
  const auto& lights = description.groups[draw.group].lights;
  for (std::size_t k = 0; k < lights.size(); ++k)
    if (lights[k].kind == bundle::GroupLight::Kind::Material &&
        static_cast<std::int32_t>(lights[k].index) == material)
      return instance.lamps[draw.group][k];
  return {};
}

// Returns the factor on a light column of a group. A lamp that was removed from the scene is dark.
glm::vec3 radianceOf(const ecs::Registry& registry, ecs::Entity entity) {
  if (const auto* material = registry.tryGet<scene::LampComponent>(entity)) return material->radiance();
  const auto* lamp = registry.tryGet<scene::LocalLightComponent>(entity);
  return lamp ? lamp->power() : glm::vec3(0.0f);
}

const gltf::Material& materialIn(const std::vector<gltf::Material>& materials, std::int32_t index) {
  static const gltf::Material kDefault;
  return index >= 0 ? materials[static_cast<std::size_t>(index)] : kDefault;
}

}  // namespace

void World::rebuildTables() {
  group_bounds_.clear();
  lamp_of_draw_.clear();
  for (std::uint32_t slot = 0; slot < bundles_.size(); ++slot) {
    const std::optional<Bundle>& bundle = bundles_[slot];
    if (!bundle || !residency_.present(slot)) continue;
    const bundle::Description& description = bundle->reader->description();
    for (const bundle::Group& group : description.groups)
      group_bounds_.push_back({group.bounds_min, group.bounds_max});
    for (const bundle::Draw& draw : description.draws)
      lamp_of_draw_.push_back(lampOf(description, bundle->instance, draw));
  }
}

std::vector<scene::AnimatedBundle> World::animatedBundles() const {
  std::vector<scene::AnimatedBundle> animated;
  for (std::size_t i = 0; i < bundles_.size(); ++i)
    if (bundles_[i])
      animated.push_back({.bundle = static_cast<std::uint32_t>(i),
                          .description = &bundles_[i]->reader->description(),
                          .instance = &bundles_[i]->instance});
  return animated;
}

void World::playAnimations(float seconds) {
  scene::playAnimations(registry_, animatedBundles(), seconds);
}

void World::setAnimationTime(float time_s) {
  scene::setAnimationTime(registry_, animatedBundles(), time_s);
}

void World::updateTransforms() {
  scene::updateTransforms(registry_);
}

std::uint64_t World::keyOf(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  const ecs::Entity entity = bundles_[resident.bundle]->instance.groups[resident.index.value];
  return std::uint64_t{entity.generation} << 32 | entity.index;
}

const scene::RigidGroupComponent* World::rigidGroup(std::uint32_t bundle, bundle::GroupIndex group) const {
  return registry_.tryGet<scene::RigidGroupComponent>(bundles_[bundle]->instance.groups[group.value]);
}

const scene::RigidGroupComponent* World::rigidGroup(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  return rigidGroup(resident.bundle, resident.index);
}

glm::quat World::rotationOf(std::size_t group) const {
  const auto* rigid = rigidGroup(group);
  return rigid ? rigid->rotation : glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
}

glm::mat4 World::worldFromGroup(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  return worldFromGroup(resident.bundle, resident.index);
}

glm::mat4 World::worldFromGroup(std::uint32_t bundle, bundle::GroupIndex group) const {
  const auto* rigid = rigidGroup(bundle, group);
  if (!rigid) return glm::mat4(1.0f);
  glm::mat4 rest = glm::mat4_cast(rigid->rest_rotation);
  rest[3] = glm::vec4(rigid->rest_translation, 1.0f);
  return rigid->world_from_rest * rest;
}

bool World::inPlace(std::uint32_t slot, bundle::GroupIndex group, std::size_t column) const {
  const Bundle& bundle = *bundles_[slot];
  const bundle::Group& described = bundle.reader->description().groups[group.value];
  const bundle::GroupLight& light = described.lights[column];
  if (light.kind == bundle::GroupLight::Kind::Material) return true;
  // Bundles of version 0.10 have columns for directional lights, which are key lights now.
  const std::int32_t carried = bundle.reader->description().nodes[light.index].light;
  if (bundle.reader->description().lights[static_cast<std::size_t>(carried)].type ==
      gltf::Light::Type::Directional)
    return false;
  const auto* now = registry_.tryGet<scene::WorldTransform>(bundle.instance.nodes[light.index]);
  const auto* rigid = rigidGroup(slot, group);
  if (!now || !rigid) return false;
  const glm::mat4 expected = rigid->world_from_rest * bundle.world_from_node_at_rest[light.index];
  // Matrices that were composed in another order differ by rounding.
  constexpr float kTolerance = 1e-4f;
  const scene::Box bounds{described.bounds_min, described.bounds_max};
  const float size = bounds.empty() ? 0.0f : bounds.radius();
  if (glm::distance(glm::vec3(expected[3]), glm::vec3(now->world_from_node[3])) > kTolerance * size)
    return false;
  const auto axis = [](const glm::mat4& matrix) {
    const glm::vec3 z(matrix[2]);
    const float length = glm::length(z);
    return length > 0.0f ? z / length : z;
  };
  return glm::distance(axis(expected), axis(now->world_from_node)) <= kTolerance;
}

std::vector<glm::vec3> World::lampsOf(std::size_t group) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  return lampsOf(resident.bundle, resident.index);
}

std::vector<glm::vec3> World::lampsOf(std::uint32_t bundle, bundle::GroupIndex group) const {
  std::vector<glm::vec3> lamps;
  for (const ecs::Entity lamp : bundles_[bundle]->instance.lamps[group.value])
    lamps.push_back(inPlace(bundle, group, lamps.size()) ? radianceOf(registry_, lamp) : glm::vec3(0.0f));
  return lamps;
}

bool World::litByColumn(std::size_t group, ecs::Entity light) const {
  const streaming::ResidentGroup& resident = residency_.groups()[group];
  const auto& lamps = bundles_[resident.bundle]->instance.lamps[resident.index.value];
  for (std::size_t k = 0; k < lamps.size(); ++k)
    if (lamps[k] == light) return inPlace(resident.bundle, resident.index, k);
  return false;
}

glm::vec3 World::emission(std::size_t draw) const {
  if (lamp_of_draw_[draw] != ecs::Entity{}) return radianceOf(registry_, lamp_of_draw_[draw]);
  return material(draw).emissive;
}

void World::updateMaterials() {
  const std::uint64_t version = registry_.version<scene::MaterialComponent>();
  if (version == materials_seen_) return;
  for (auto [entity, component] : registry_.view<const scene::MaterialComponent>()) {
    if (registry_.version<scene::MaterialComponent>(entity) <= materials_seen_) continue;
    if (component.bundle >= bundles_.size() || !bundles_[component.bundle]) continue;
    Bundle& bundle = *bundles_[component.bundle];
    if (component.material >= bundle.materials.size()) continue;
    bundle.materials[component.material] =
        scene::withComponent(bundle.reader->description().materials[component.material], component);
    ++materials_version_;
  }
  materials_seen_ = version;
}

const gltf::Material& World::material(std::size_t draw) const {
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  return materialIn(bundles_[resident.bundle]->materials, resident.material);
}

const gltf::Material& World::bakedMaterial(std::size_t draw) const {
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  return materialIn(bundles_[resident.bundle]->reader->description().materials, resident.material);
}

void World::scaleLamps(float factor) {
  for (auto [entity, lamp] : registry_.view<const scene::LampComponent>())
    registry_.edit<scene::LampComponent>(entity).strength *= factor;
  for (const std::optional<Bundle>& bundle : bundles_)
    for (const ecs::Entity node : bundle ? bundle->instance.nodes : std::vector<ecs::Entity>())
      if (registry_.has<scene::LocalLightComponent>(node))
        registry_.edit<scene::LocalLightComponent>(node).strength *= factor;
}

glm::mat4 World::worldFromMesh(std::size_t draw) const {
  const streaming::ResidentDraw& resident = residency_.draws()[draw];
  const auto* item =
      registry_.tryGet<scene::DrawItem>(bundles_[resident.bundle]->instance.draws[resident.index]);
  const auto* place = item ? registry_.tryGet<scene::WorldTransform>(item->node) : nullptr;
  return place ? place->world_from_node : glm::mat4(1.0f);
}

}  // namespace lambent::frame
