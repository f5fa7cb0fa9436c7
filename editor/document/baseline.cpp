#include "editor/document/baseline.hpp"

#include <utility>

#include "runtime/scene/components.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {
namespace {

std::string key(scene::StableId id, std::string_view field) {
  return std::to_string(id.value) + "/" + std::string(field);
}

}  // namespace

Result<Baseline> Baseline::create(std::span<const BaselineBundle> bundles) {
  Baseline baseline;
  std::uint32_t index = 0;
  for (const BaselineBundle& bundle : bundles) {
    const Result<scene::SceneInstance> made =
        scene::instantiate(baseline.registry_, *bundle.description,
                           {.bundle_index = index++, .bundle_id = bundle.id, .instance = bundle.instance});
    if (!made) return failAgain(made.error());
    constexpr std::string_view kFields[] = {"translation", "rotation", "scale"};
    for (const gltf::Animation& animation : bundle.description->animations) {
      for (const gltf::AnimationChannel& channel : animation.channels)
        baseline.animated_.insert(key(baseline.registry_.get<scene::StableId>(made->nodes[channel.node]),
                                      kFields[static_cast<std::size_t>(channel.path)]));
    }
  }
  for (auto [entity, id] : std::as_const(baseline.registry_).view<scene::StableId>())
    baseline.entities_.emplace(id.value, entity);
  return baseline;
}

ecs::Entity Baseline::find(scene::StableId id) const {
  const auto found = entities_.find(id.value);
  return found == entities_.end() ? ecs::Entity{} : found->second;
}

std::optional<scene::Value> Baseline::value(scene::StableId id, const scene::FieldInfo& field) const {
  const ecs::Entity entity = find(id);
  const scene::ComponentInfo* component = scene::findComponent(field.component);
  if (!entity || !component->has(registry_, entity)) return std::nullopt;
  return field.get(registry_, entity);
}

scene::StableId Baseline::parent(scene::StableId id) const {
  const auto* place = registry_.tryGet<scene::Transform>(find(id));
  const auto* parent = place ? registry_.tryGet<scene::StableId>(place->parent) : nullptr;
  return parent ? *parent : scene::StableId{};
}

bool Baseline::animated(scene::StableId id, std::string_view transform_field) const {
  return animated_.contains(key(id, transform_field));
}

}  // namespace lambent::editor
