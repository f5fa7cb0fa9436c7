#include <cassert>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::scene {
namespace {

// A bundle in a registry of its own, with its entities as they are before any changes.
struct Untouched {
  ecs::Registry registry;
  SceneInstance instance;

  Untouched(const bundle::Description& description, const InstantiateOptions& options) {
    Result<SceneInstance> made = instantiate(registry, description, options);
    assert(made && "an empty registry takes any bundle");
    instance = std::move(*made);
  }
};

template <class Instance, class Visitor>
void forEachEntity(Instance& instance, const Visitor& visit) {
  visit(instance.root);
  for (auto* list :
       {&instance.nodes, &instance.groups, &instance.draws, &instance.animations, &instance.materials})
    for (auto& entity : *list) visit(entity);
  for (auto& lamps : instance.lamps)
    for (auto& entity : lamps) visit(entity);
}

std::vector<ecs::Entity> listOf(const SceneInstance& instance) {
  std::vector<ecs::Entity> list;
  forEachEntity(instance, [&](ecs::Entity entity) { list.push_back(entity); });
  return list;
}

class Exchange {
 public:
  Exchange(ecs::Registry& registry, const SceneInstance& instance, const bundle::Description& before,
           const bundle::Description& now, const InstantiateOptions& options)
      : registry_(registry), instance_(instance), before_(before), was_(before, options), is_(now, options) {}

  SceneInstance run() {
    matchEntities();
    takePosesBack();
    for (const auto& [entity, made] : entity_of_) {
      const ecs::Entity old = find(old_of_, entity);
      if (!registry_.alive(made)) continue;  // the user destroyed it
      exchangeTransform(made, old, entity);
      exchangeFields<Name, CameraComponent, LocalLightComponent, LampComponent, AnimationComponent,
                     MaterialComponent>(made, old, entity);
      exchangeDerived(made, old, entity);
    }
    for (const ecs::Entity player : to_pose_)
      if (auto* animation = registry_.tryGet<AnimationComponent>(player))
        animation->posed_s = std::numeric_limits<float>::quiet_NaN();
    for (const ecs::Entity entity : gone_) registry_.destroy(entity);
    updateTransforms(registry_);
    placeGroups();
    updateTransforms(registry_);
    return mapped(is_.instance);
  }

 private:
  // Matches entities of both bundles by their ids and creates those that only the new one has.
  void matchEntities() {
    std::map<StableId, std::pair<ecs::Entity, ecs::Entity>> old;  // entities in was_ and in the registry
    const std::vector<ecs::Entity> were = listOf(was_.instance), are = listOf(instance_);
    for (std::size_t i = 0; i < were.size(); ++i)
      old[was_.registry.get<StableId>(were[i])] = {were[i], are[i]};
    std::set<StableId> kept;
    forEachEntity(is_.instance, [&](ecs::Entity entity) {
      if (entity_of_.contains(entity)) return;  // a lamp that is also a node
      const StableId id = is_.registry.get<StableId>(entity);
      if (const auto found = old.find(id); found != old.end()) {
        kept.insert(id);
        old_of_[entity] = found->second.first;
        entity_of_[entity] = found->second.second;
        return;
      }
      const ecs::Entity made = registry_.create();
      registry_.emplace<StableId>(made, id);
      entity_of_[entity] = made;
    });
    for (const auto& [id, entities] : old) {
      now_of_old_[entities.first] = entities.second;
      if (!kept.contains(id)) gone_.push_back(entities.second);
    }
  }

  using Entities = std::map<ecs::Entity, ecs::Entity>;
  static ecs::Entity find(const Entities& in, ecs::Entity entity) {
    const auto found = in.find(entity);
    return found == in.end() ? ecs::Entity{} : found->second;
  }
  ecs::Entity entityOf(ecs::Entity entity) const { return find(entity_of_, entity); }

  // Resets parts of transforms that have the pose of an animation, since the user did not change them.
  void takePosesBack() {
    using Path = gltf::AnimationChannel::Path;
    for (std::size_t a = 0; a < instance_.animations.size(); ++a) {
      const auto* player = registry_.tryGet<AnimationComponent>(instance_.animations[a]);
      if (!player) continue;
      for (const gltf::AnimationChannel& channel : before_.animations[a].channels) {
        Transform* now = registry_.tryGet<Transform>(instance_.nodes[channel.node]);
        if (!now) continue;
        const gltf::Trs stands{
            .translation = now->translation, .rotation = now->rotation, .scale = now->scale};
        gltf::Trs posed = stands;
        gltf::applyChannel(channel, player->posed_s, posed);
        const auto& was = was_.registry.get<Transform>(was_.instance.nodes[channel.node]);
        const gltf::Trs at_rest{.translation = was.translation, .rotation = was.rotation, .scale = was.scale};
        if (!(posed == stands) || stands == at_rest) continue;
        if (channel.path == Path::Translation) now->translation = was.translation;
        if (channel.path == Path::Rotation) now->rotation = was.rotation;
        if (channel.path == Path::Scale) now->scale = was.scale;
        registry_.touch<Transform>(instance_.nodes[channel.node]);
        to_pose_.insert(instance_.animations[a]);
      }
    }
  }

  // Copies fields that the user changed into `value`, which has those of the new bundle.
  template <class Component>
  static void keepChanges(Component& value, const Component& was, const Component& stands) {
    std::apply(
        [&](const auto&... field) {
          (..., (field.of(stands) != field.of(was) ? void(field.of(value) = field.of(stands)) : void()));
        },
        Component::fields());
  }

  // Returns the component to put on the entity, or nothing if the entity must stay as it is.
  template <class Component>
  std::optional<Component> merged(ecs::Entity entity, ecs::Entity old, ecs::Entity now) {
    const Component* stands = registry_.tryGet<Component>(entity);
    const Component* was = was_.registry.tryGet<Component>(old);
    const Component* is = is_.registry.tryGet<Component>(now);
    if (!is) {
      if (was && stands) registry_.remove<Component>(entity);
      return {};
    }
    if (was ? !stands : stands != nullptr) return {};  // the user removed or added it
    Component value = *is;
    if (was) keepChanges(value, *was, *stands);
    return value;
  }

  template <class... Component>
  void exchangeFields(ecs::Entity entity, ecs::Entity old, ecs::Entity now) {
    const auto exchange = [&]<class C>(std::optional<C> value) {
      if (!value) return;
      if constexpr (std::is_same_v<C, AnimationComponent>)
        if (const auto* stands = registry_.tryGet<C>(entity)) value->posed_s = stands->posed_s;
      registry_.emplace<C>(entity, std::move(*value));
    };
    (exchange(merged<Component>(entity, old, now)), ...);
  }

  void exchangeTransform(ecs::Entity entity, ecs::Entity old, ecs::Entity now) {
    std::optional<Transform> value = merged<Transform>(entity, old, now);
    if (!value) return;
    value->parent = entityOf(value->parent);
    const Transform* stands = registry_.tryGet<Transform>(entity);
    if (stands) {
      const ecs::Entity expected = find(now_of_old_, was_.registry.get<Transform>(old).parent);
      if (stands->parent != expected) value->parent = stands->parent;  // the user changed the parent
    }
    registry_.emplace<Transform>(entity, *value);
  }

  // Replaces components that users cannot change.
  void exchangeDerived(ecs::Entity entity, ecs::Entity old, ecs::Entity now) {
    if (const auto* is = is_.registry.tryGet<DrawItem>(now)) {
      DrawItem item = *is;
      item.node = entityOf(item.node);
      item.group = entityOf(item.group);
      registry_.emplace<DrawItem>(entity, item);
    }
    if (const auto* is = is_.registry.tryGet<VolumeItem>(now))
      registry_.emplace<VolumeItem>(entity, *is);
    else if (was_.registry.has<VolumeItem>(old))
      registry_.remove<VolumeItem>(entity);
    if (const auto* is = is_.registry.tryGet<RigidGroupComponent>(now)) {
      RigidGroupComponent group = *is;
      group.node = entityOf(group.node);
      group.seen_node = 0;
      registry_.emplace<RigidGroupComponent>(entity, group);
    }
  }

  // Sets groups whose node is where it was baked to exactly their rest transform, as if the bundle had just
  // been opened.
  void placeGroups() {
    for (const ecs::Entity now : is_.instance.groups) {
      const ecs::Entity entity = entityOf(now);
      if (!registry_.has<RigidGroupComponent>(entity)) continue;
      const auto& is = is_.registry.get<RigidGroupComponent>(now);
      const ecs::Entity node = entityOf(is.node);
      const auto* stands = registry_.tryGet<WorldTransform>(node);
      const auto* rest = is_.registry.tryGet<WorldTransform>(is.node);
      if (!stands || !rest || stands->world_from_node != rest->world_from_node) continue;
      RigidGroupComponent group = is;
      group.node = node;
      group.seen_node = registry_.version<WorldTransform>(node);
      registry_.emplace<RigidGroupComponent>(entity, group);
    }
  }

  SceneInstance mapped(SceneInstance instance) const {
    forEachEntity(instance, [&](ecs::Entity& entity) { entity = entityOf(entity); });
    return instance;
  }

  ecs::Registry& registry_;
  const SceneInstance& instance_;
  const bundle::Description& before_;
  const Untouched was_, is_;
  Entities entity_of_, old_of_;  // from is_ to the registry, and from is_ to was_
  Entities now_of_old_;          // from was_ to the registry
  std::vector<ecs::Entity> gone_;
  std::set<ecs::Entity> to_pose_;
};

}  // namespace

SceneInstance exchangeInstance(ecs::Registry& registry, const SceneInstance& instance,
                               const bundle::Description& before, const bundle::Description& now,
                               const InstantiateOptions& options) {
  return Exchange(registry, instance, before, now, options).run();
}

}  // namespace lambent::scene
