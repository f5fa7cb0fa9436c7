#include "editor/document/overrides.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "editor/document/document.hpp"
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

namespace {

// Returns whether an animation sets this field at present. Such a value is not an edit.
bool follows(const ecs::Registry& registry, ecs::Entity entity, StableId id, const Baseline& baseline,
             const scene::FieldInfo& field) {
  if (field.component == "Transform") return baseline.animated(id, field.name);
  const auto* animation = registry.tryGet<scene::AnimationComponent>(entity);
  return animation && animation->playing && field.component == "Animation" && field.name == "time";
}

EntityOverride created(const Document& document, ecs::Entity entity, StableId id) {
  const ecs::Registry& registry = document.registry();
  EntityOverride whole;
  whole.id = id;
  whole.created = true;
  whole.name = document.nameOf(entity);
  if (registry.has<scene::Transform>(entity)) whole.parent = document.idOf(parentOf(registry, entity));
  for (const scene::ComponentInfo& component : scene::components()) {
    if (!component.addable || !component.has(registry, entity)) continue;
    whole.components.push_back(&component);
    for (const scene::FieldInfo& field : component.fields)
      whole.fields.push_back({&field, field.get(registry, entity)});
  }
  return whole;
}

EntityOverride differences(const Document& document, ecs::Entity entity, StableId id,
                           const Baseline& baseline) {
  const ecs::Registry& registry = document.registry();
  EntityOverride found;
  found.id = id;
  found.name = document.nameOf(entity);
  if (registry.has<scene::Transform>(entity)) {
    const StableId parent = document.idOf(parentOf(registry, entity));
    if (parent != baseline.parent(id)) found.parent = parent;
  }
  for (const scene::ComponentInfo& component : scene::components()) {
    if (!component.has(registry, entity)) continue;
    for (const scene::FieldInfo& field : component.fields) {
      const std::optional<scene::Value> before = baseline.value(id, field);
      scene::Value now = field.get(registry, entity);
      if (!before || scene::sameBits(*before, now) || follows(registry, entity, id, baseline, field))
        continue;
      found.fields.push_back({&field, std::move(now)});
    }
  }
  return found;
}

}  // namespace

Overrides captureOverrides(Document& document, const Baseline& baseline) {
  document.adoptAll();
  Overrides overrides;
  const ecs::Registry& registry = document.registry();
  for (auto [entity, id] : registry.view<StableId>()) {
    if (document.created(entity)) {
      overrides.push_back(created(document, entity, id));
    } else if (baseline.find(id)) {
      EntityOverride found = differences(document, entity, id, baseline);
      if (found.parent || !found.fields.empty()) overrides.push_back(std::move(found));
    }
  }
  std::sort(overrides.begin(), overrides.end(),
            [](const EntityOverride& a, const EntityOverride& b) { return a.id < b.id; });
  return overrides;
}

ApplyReport applyOverrides(Document& document, const Overrides& overrides) {
  ApplyReport report;
  ecs::Registry& registry = document.registry();
  for (const EntityOverride& entry : overrides) {
    ecs::Entity entity = document.find(entry.id);
    if (!entity && entry.created) {
      entity = makeEntity(document, {entry.id, kNoId, {}});
      for (const scene::ComponentInfo* component : entry.components) component->add(registry, entity);
    }
    if (!entity) {
      report.missing.push_back(fmt::format("{} ({})", entry.name, idText(entry.id)));
      continue;
    }
    for (const FieldOverride& field : entry.fields) {
      if (!field.field->restore(registry, entity, field.value))
        report.missing.push_back(fmt::format("{} of {}", field.field->component, entry.name));
    }
  }
  // Parents are set last, when all entities exist. A file may be wrong, so an entity is never put below
  // itself.
  for (const EntityOverride& entry : overrides) {
    const ecs::Entity entity = document.find(entry.id);
    auto* place = registry.tryGet<scene::Transform>(entity);
    if (!place || !entry.parent) continue;
    const ecs::Entity parent = document.find(*entry.parent);
    if (*entry.parent != kNoId && (!parent || isBelow(registry, parent, entity))) {
      report.missing.push_back(fmt::format("parent of {} ({})", entry.name, idText(*entry.parent)));
      continue;
    }
    if (place->parent != parent) registry.edit<scene::Transform>(entity).parent = parent;
  }
  return report;
}

}  // namespace lambent::editor
