#include "runtime/scene/instantiate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::scene {

namespace {

// Appends a value in little-endian order on every machine. Values of fixed size come first and text last, so
// no two inputs give the same bytes.
template <class T>
void append(std::vector<std::byte>& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
}

StableId hash(std::uint64_t parent, std::uint8_t kind, std::uint32_t ordinal, std::string_view name) {
  std::vector<std::byte> bytes;
  append(bytes, parent);
  append(bytes, ordinal);
  bytes.push_back(static_cast<std::byte>(kind));
  for (const char c : name) bytes.push_back(static_cast<std::byte>(c));
  return {bundle::checksum(bytes)};
}

}  // namespace

StableId instanceId(std::string_view bundle_id, std::uint32_t instance) {
  return hash(0, 0, instance, bundle_id);
}

StableId childId(StableId parent, StableKind kind, std::string_view name, std::uint32_t ordinal) {
  return hash(parent.value, static_cast<std::uint8_t>(kind), ordinal, name);
}

namespace {

class Instantiation {
 public:
  Instantiation(ecs::Registry& registry, const bundle::Description& description,
                const InstantiateOptions& options)
      : registry_(registry), description_(description), options_(options) {}

  SceneInstance run() {
    makeRoot();
    makeNodes();
    updateTransforms(registry_);  // groups need their root's matrix at rest
    makeGroups();
    makeDraws();
    makeLamps();
    makeAnimations();
    makeMaterials();
    return std::move(instance_);
  }

 private:
  void makeRoot() {
    instance_.root = registry_.create();
    registry_.emplace<Name>(instance_.root, options_.bundle_id);
    registry_.emplace<StableId>(instance_.root, instanceId(options_.bundle_id, options_.instance));
    registry_.emplace<Transform>(instance_.root);
  }

  void makeNodes() {
    const auto& nodes = description_.nodes;
    instance_.nodes.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) instance_.nodes.push_back(registry_.create());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const gltf::Node& node = nodes[i];
      registry_.emplace<Name>(instance_.nodes[i], node.name);
      Transform transform;
      transform.parent = nodeOrRoot(node.parent);
      setLocalMatrix(transform, node.parent_from_node);
      if (node.trs) {  // animations replace exactly these parts
        transform.translation = node.trs->translation;
        transform.rotation = node.trs->rotation;
        transform.scale = node.trs->scale;
        transform.shear = glm::vec3(0.0f);
      }
      registry_.emplace<Transform>(instance_.nodes[i], transform);
      if (node.camera >= 0) makeCamera(instance_.nodes[i], static_cast<std::uint32_t>(node.camera));
      if (node.light >= 0)
        makeLight(instance_.nodes[i], description_.lights[static_cast<std::size_t>(node.light)]);
    }
    // An id depends on the parent's id, so parents come first. Roots and children keep the file's order,
    // which distinguishes siblings of the same name.
    std::vector<std::int32_t> open;
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (nodes[i].parent < 0) open.push_back(static_cast<std::int32_t>(i));
    }
    while (!open.empty()) {
      const gltf::Node& node = nodes[static_cast<std::size_t>(open.back())];
      const ecs::Entity entity = instance_.nodes[static_cast<std::size_t>(open.back())];
      open.pop_back();
      giveId(entity, nodeOrRoot(node.parent), StableKind::Node, node.name);
      open.insert(open.end(), node.children.rbegin(), node.children.rend());
    }
  }

  void makeCamera(ecs::Entity entity, std::uint32_t index) {
    const gltf::Camera& camera = description_.cameras[index];
    registry_.emplace<CameraComponent>(entity, CameraComponent{.bundle = options_.bundle_index,
                                                               .camera = index,
                                                               .perspective = camera.perspective,
                                                               .yfov_rad = camera.yfov_rad,
                                                               .aspect = camera.aspect,
                                                               .xmag = camera.xmag,
                                                               .ymag = camera.ymag,
                                                               .znear = camera.znear,
                                                               .zfar = camera.zfar});
  }

  void makeLight(ecs::Entity entity, const gltf::Light& light) {
    using Kind = LocalLightComponent::Kind;
    constexpr Kind kKinds[] = {Kind::Directional, Kind::Point, Kind::Spot};
    registry_.emplace<LocalLightComponent>(
        entity, LocalLightComponent{.kind = kKinds[static_cast<std::size_t>(light.type)],
                                    .color = light.color,
                                    .strength = light.intensity,
                                    .range_m = light.range_m,
                                    .inner_cone_rad = light.inner_cone_rad,
                                    .outer_cone_rad = light.outer_cone_rad});
  }

  void makeGroups() {
    for (std::size_t i = 0; i < description_.groups.size(); ++i) {
      const bundle::Group& group = description_.groups[i];
      const ecs::Entity entity = registry_.create();
      instance_.groups.push_back(entity);
      RigidGroupComponent component;
      component.bundle = options_.bundle_index;
      component.group = static_cast<std::uint32_t>(i);
      component.node = nodeOrRoot(group.node);
      component.bounds = {group.bounds_min, group.bounds_max};
      component.rest_rotation = component.rotation = group.rest_rotation;
      component.rest_translation = component.translation = group.rest_translation;
      const glm::dmat4 world_from_node(registry_.get<WorldTransform>(component.node).world_from_node);
      // A root that is flat at rest (scale 0) has no inverse and shows nothing, so its group stays where it
      // is.
      if (glm::determinant(world_from_node) != 0.0) {
        component.node_from_world_at_rest = glm::inverse(world_from_node);
        component.seen_node = registry_.version<WorldTransform>(component.node);
      } else {
        component.node = {};
      }
      registry_.emplace<RigidGroupComponent>(entity, component);
      if (group.volume)
        registry_.emplace<VolumeItem>(entity, VolumeItem{group.volume->group_from_grid, group.volume->size});
      registry_.emplace<Name>(entity, group.name);
      giveId(entity, nodeOrRoot(group.node), StableKind::Group, {});
    }
  }

  void makeDraws() {
    for (std::size_t i = 0; i < description_.draws.size(); ++i) {
      const bundle::Draw& draw = description_.draws[i];
      const bundle::Primitive& primitive = description_.meshes[draw.mesh].primitives[draw.primitive];
      const ecs::Entity entity = registry_.create();
      instance_.draws.push_back(entity);
      const ecs::Entity node = instance_.nodes[draw.node];
      registry_.emplace<DrawItem>(entity, DrawItem{.bundle = options_.bundle_index,
                                                   .draw = static_cast<std::uint32_t>(i),
                                                   .mesh = draw.mesh,
                                                   .primitive = draw.primitive,
                                                   .back = draw.back,
                                                   .material = primitive.material,
                                                   .node = node,
                                                   .group = instance_.groups[draw.group],
                                                   .bounds = {primitive.bounds_min, primitive.bounds_max}});
      registry_.emplace<StableId>(entity, childId(registry_.get<StableId>(node), StableKind::Draw,
                                                  draw.back ? "back" : "", draw.primitive));
    }
  }

  void makeLamps() {
    using Kind = bundle::GroupLight::Kind;
    for (std::uint32_t g = 0; g < description_.groups.size(); ++g) {
      instance_.lamps.emplace_back();
      const auto& lights = description_.groups[g].lights;
      for (std::uint32_t k = 0; k < lights.size(); ++k) {
        // The entity of a KHR light is its node, whether it shines on its own group or on others. An emissive
        // material has one lamp in each group that it lights.
        if (lights[k].kind == Kind::Node) {
          instance_.lamps.back().push_back(instance_.nodes[lights[k].index]);
          continue;
        }
        make(instance_.lamps.back(), instance_.groups[g], StableKind::Lamp,
             description_.materials[lights[k].index].name,
             LampComponent{
                 .bundle = options_.bundle_index, .group = g, .column = k, .color = lights[k].color});
      }
    }
  }

  void makeAnimations() {
    for (std::uint32_t i = 0; i < description_.animations.size(); ++i)
      make(instance_.animations, instance_.root, StableKind::Animation, description_.animations[i].name,
           AnimationComponent{.bundle = options_.bundle_index, .animation = i});
  }

  void makeMaterials() {
    for (std::uint32_t i = 0; i < description_.materials.size(); ++i)
      make(instance_.materials, instance_.root, StableKind::Material, description_.materials[i].name,
           materialComponent(description_.materials[i], options_.bundle_index, i));
  }

  // Makes an entity of a list, with a component.
  template <class Component>
  void make(std::vector<ecs::Entity>& list, ecs::Entity parent, StableKind kind, const std::string& name,
            const Component& component) {
    const ecs::Entity entity = list.emplace_back(registry_.create());
    registry_.emplace<Component>(entity, component);
    registry_.emplace<Name>(entity, name);
    giveId(entity, parent, kind, name);
  }

  ecs::Entity nodeOrRoot(std::int32_t node) const {
    return node < 0 ? instance_.root : instance_.nodes[static_cast<std::size_t>(node)];
  }

  void giveId(ecs::Entity entity, ecs::Entity parent, StableKind kind, std::string_view name) {
    const StableId parent_id = registry_.get<StableId>(parent);
    const std::uint32_t ordinal = given_[{parent_id, kind, name}]++;
    registry_.emplace<StableId>(entity, childId(parent_id, kind, name, ordinal));
  }

  ecs::Registry& registry_;
  const bundle::Description& description_;
  const InstantiateOptions& options_;
  SceneInstance instance_;
  std::map<std::tuple<StableId, StableKind, std::string_view>, std::uint32_t> given_;
};

}  // namespace

Result<SceneInstance> instantiate(ecs::Registry& registry, const bundle::Description& description,
                                  const InstantiateOptions& options) {
  const StableId root_id = instanceId(options.bundle_id, options.instance);
  for (auto [entity, id] : registry.view<const StableId>()) {
    if (id == root_id)
      return fail(options.bundle_id,
                  "stands in the scene already as instance " + std::to_string(options.instance),
                  "give it another instance number");
  }
  return Instantiation(registry, description, options).run();
}

// Entities are destroyed in reverse order of their creation. Indices are reused last in, first out, so a
// bundle that is instantiated again gets the same order, in which trees show it.
void destroyInstance(ecs::Registry& registry, const SceneInstance& instance) {
  const auto destroyAll = [&](const std::vector<ecs::Entity>& list) {
    for (auto entity = list.rbegin(); entity != list.rend(); ++entity) registry.destroy(*entity);
  };
  destroyAll(instance.materials);
  destroyAll(instance.animations);
  // Lamps that are nodes are destroyed with the nodes.
  for (auto lamps = instance.lamps.rbegin(); lamps != instance.lamps.rend(); ++lamps)
    for (auto lamp = lamps->rbegin(); lamp != lamps->rend(); ++lamp)
      if (registry.tryGet<LampComponent>(*lamp)) registry.destroy(*lamp);
  destroyAll(instance.draws);
  destroyAll(instance.groups);
  destroyAll(instance.nodes);
  registry.destroy(instance.root);
}

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
    if constexpr (std::is_same_v<Value, glm::vec3>) good = isFinite(value);
    if constexpr (std::is_same_v<Value, float>) good = good && std::isfinite(value);
    if (!good) value = field.of(before);
  });
  return gltf::withFactors(baked, now);
}

namespace {

using Kind = LocalLightComponent::Kind;

// Makes the brightest channel the strength, so that colours are within 0..1.
LocalLightComponent lightOf(Kind kind, float radius_m, glm::vec3 radiance) {
  const float strength = std::max({radiance.r, radiance.g, radiance.b});
  return {.kind = kind,
          .color = strength > 0.0f ? radiance / strength : glm::vec3(1.0f),
          .strength = strength,
          .radius_m = radius_m};
}

}  // namespace

glm::quat facing(glm::vec3 direction) {
  const glm::dvec3 to = glm::normalize(glm::dvec3(direction)), from(0.0, 0.0, -1.0);
  const double w = 1.0 + glm::dot(from, to);
  if (w < 1e-12) return {0.0f, 0.0f, 1.0f, 0.0f};  // half a turn about +Y
  const glm::dvec3 axis = glm::cross(from, to);
  return glm::quat(glm::normalize(glm::dquat(w, axis.x, axis.y, axis.z)));
}

std::vector<ecs::Entity> addLights(ecs::Registry& registry, std::span<const spec::Light> lights,
                                   const glm::dvec3& origin) {
  std::vector<ecs::Entity> entities;
  for (const spec::LocalLight& light : spec::localLights(lights, origin)) {
    const ecs::Entity entity = entities.emplace_back(registry.create());
    Transform place;
    if (const auto* sphere = std::get_if<spec::SphereLight>(&light)) {
      place.translation = glm::vec3(sphere->position_ws);
      registry.emplace<LocalLightComponent>(entity,
                                            lightOf(Kind::Sphere, sphere->radius_m, sphere->radiance));
    } else if (const auto* disc = std::get_if<spec::DiscLight>(&light)) {
      place.translation = glm::vec3(disc->position_ws);
      place.rotation = facing(disc->normal_ws);
      registry.emplace<LocalLightComponent>(entity, lightOf(Kind::Disc, disc->radius_m, disc->radiance));
    }
    registry.emplace<Transform>(entity, place);
    registry.emplace<Name>(entity, "light " + std::to_string(entities.size()));
  }
  return entities;
}

ecs::Entity addEnvironment(ecs::Registry& registry, const EnvironmentComponent& environment) {
  const ecs::Entity entity = registry.create();
  registry.emplace<Name>(entity, "environment");
  registry.emplace<EnvironmentComponent>(entity, environment);
  return entity;
}

}  // namespace lambent::scene
