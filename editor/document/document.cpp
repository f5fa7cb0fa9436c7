#include "editor/document/document.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/components.hpp"
#include "runtime/scene/reflection.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {

StableId environmentId() {
  return scene::instanceId("environment", 0);
}

std::string idText(StableId id) {
  return fmt::format("{:016x}", id.value);
}

std::optional<StableId> parseId(std::string_view text) {
  if (text.size() != 16) return std::nullopt;
  StableId id;
  for (const char c : text) {
    const bool digit = c >= '0' && c <= '9', letter = c >= 'a' && c <= 'f';
    if (!digit && !letter) return std::nullopt;
    id.value = id.value << 4 | static_cast<std::uint64_t>(digit ? c - '0' : c - 'a' + 10);
  }
  return id;
}

Document::Document(ecs::Registry& registry, std::optional<std::uint64_t> seed) : registry_(&registry) {
  if (seed) {
    seed_ = *seed;
  } else {
    std::random_device source;
    seed_ = std::uint64_t{source()} << 32 | source();
  }
}

void Document::setWorld(WorldState world) {
  if (world == world_) return;
  world_ = std::move(world);
  ++world_version_;
}

void Document::index() const {
  entities_.clear();
  for (auto [entity, id] : std::as_const(*registry_).view<StableId>()) entities_.emplace(id.value, entity);
  indexed_version_ = registry_->version<StableId>();
}

ecs::Entity Document::find(StableId id) const {
  if (id == kNoId) return {};
  const auto lookUp = [&]() -> ecs::Entity {
    const auto found = entities_.find(id.value);
    if (found == entities_.end()) return {};
    const StableId* there = registry_->tryGet<StableId>(found->second);
    return there && *there == id ? found->second : ecs::Entity{};
  };
  if (const ecs::Entity entity = lookUp()) return entity;
  if (indexed_version_ == registry_->version<StableId>()) return {};
  index();
  return lookUp();
}

StableId Document::idOf(ecs::Entity entity) const {
  const StableId* id = registry_->tryGet<StableId>(entity);
  return id ? *id : kNoId;
}

StableId Document::newId() {
  for (;;) {
    const StableId id = scene::childId({seed_}, scene::StableKind::Node, "created", given_++);
    if (id != kNoId && !find(id)) return id;
  }
}

StableId Document::adopt(ecs::Entity entity) {
  if (const StableId id = idOf(entity); id != kNoId) return id;
  const bool environment = registry_->has<scene::EnvironmentComponent>(entity) && !find(environmentId());
  const StableId id = environment ? environmentId() : newId();
  registry_->emplace<StableId>(entity, id);
  if (!environment) registry_->emplace<Created>(entity);
  entities_[id.value] = entity;
  return id;
}

void Document::adoptAll() {
  for (const ecs::Entity entity : registry_->entities()) {
    const auto all = scene::components();
    if (std::any_of(all.begin(), all.end(), [&](const auto& row) { return row.has(*registry_, entity); }))
      adopt(entity);
  }
}

std::string Document::nameOf(ecs::Entity entity) const {
  const scene::Name* name = registry_->tryGet<scene::Name>(entity);
  if (name && !name->value.empty()) return name->value;
  return "entity " + idText(idOf(entity));
}

std::string Document::nameOf(StableId id) const {
  const ecs::Entity entity = find(id);
  return entity ? nameOf(entity) : "entity " + idText(id);
}

ecs::Entity parentOf(const ecs::Registry& registry, ecs::Entity entity) {
  const auto* place = registry.tryGet<scene::Transform>(entity);
  return place && registry.alive(place->parent) ? place->parent : ecs::Entity{};
}

bool isBelow(const ecs::Registry& registry, ecs::Entity entity, ecs::Entity ancestor) {
  for (; entity; entity = parentOf(registry, entity)) {
    if (entity == ancestor) return true;
  }
  return false;
}

std::vector<ecs::Entity> withDescendants(const ecs::Registry& registry,
                                         const std::vector<ecs::Entity>& entities) {
  std::unordered_map<std::uint32_t, std::vector<ecs::Entity>> children;
  for (auto [entity, place] : registry.view<scene::Transform>()) {
    if (const ecs::Entity parent = parentOf(registry, entity)) children[parent.index].push_back(entity);
  }
  std::unordered_map<std::uint32_t, bool> seen;
  std::vector<ecs::Entity> all;
  // Entities below others of the list are added with those.
  for (const ecs::Entity start : entities) {
    const bool below = std::any_of(entities.begin(), entities.end(), [&](ecs::Entity other) {
      return other != start && isBelow(registry, start, other);
    });
    if (below || seen[start.index]) continue;
    std::vector<ecs::Entity> open{start};
    while (!open.empty()) {
      const ecs::Entity entity = open.back();
      open.pop_back();
      if (std::exchange(seen[entity.index], true)) continue;
      all.push_back(entity);
      std::vector<ecs::Entity> below_it = children[entity.index];
      std::sort(below_it.begin(), below_it.end(), std::greater<>());
      open.insert(open.end(), below_it.begin(), below_it.end());
    }
  }
  return all;
}

glm::mat4 worldFromNode(const ecs::Registry& registry, ecs::Entity entity) {
  glm::mat4 matrix(1.0f);
  for (; entity; entity = parentOf(registry, entity)) {
    if (const auto* place = registry.tryGet<scene::Transform>(entity))
      matrix = scene::localMatrix(*place) * matrix;
  }
  return matrix;
}

const scene::Value* EntitySnapshot::find(std::string_view component, std::string_view field) const {
  for (const ComponentValues& part : components) {
    if (part.component->name != component) continue;
    for (std::size_t i = 0; i < part.values.size(); ++i) {
      if (part.component->fields[i].name == field) return &part.values[i];
    }
  }
  return nullptr;
}

void EntitySnapshot::put(std::string_view component, std::string_view field, scene::Value value) {
  for (ComponentValues& part : components) {
    if (part.component->name != component) continue;
    for (std::size_t i = 0; i < part.values.size(); ++i)
      if (part.component->fields[i].name == field) part.values[i] = std::move(value);
  }
}

ComponentValues componentValues(const ecs::Registry& registry, ecs::Entity entity,
                                const scene::ComponentInfo& component) {
  ComponentValues part{&component, {}};
  for (const scene::FieldInfo& field : component.fields) part.values.push_back(field.get(registry, entity));
  return part;
}

EntitySnapshot takeSnapshot(const Document& document, ecs::Entity entity) {
  const ecs::Registry& registry = document.registry();
  EntitySnapshot snapshot{document.idOf(entity), document.idOf(parentOf(registry, entity)), {}};
  for (const scene::ComponentInfo& component : scene::components()) {
    if (component.has(registry, entity))
      snapshot.components.push_back(componentValues(registry, entity, component));
  }
  return snapshot;
}

ecs::Entity makeEntity(Document& document, const EntitySnapshot& snapshot) {
  ecs::Registry& registry = document.registry();
  const ecs::Entity entity = registry.create();
  registry.emplace<StableId>(entity, snapshot.id == kNoId ? document.newId() : snapshot.id);
  registry.emplace<Created>(entity);
  for (const ComponentValues& part : snapshot.components) {
    part.component->add(registry, entity);
    for (std::size_t i = 0; i < part.values.size(); ++i)
      part.component->fields[i].restore(registry, entity, part.values[i]);
  }
  if (auto* place = registry.tryGet<scene::Transform>(entity)) place->parent = document.find(snapshot.parent);
  return entity;
}

namespace {

ComponentValues defaults(std::string_view component) {
  ComponentValues part{scene::findComponent(component), {}};
  for (const scene::FieldInfo& info : part.component->fields) part.values.push_back(info.default_value);
  return part;
}

}  // namespace

EntitySnapshot emptyEntity(std::string name) {
  EntitySnapshot snapshot{kNoId, kNoId, {defaults("Name"), defaults("Transform")}};
  snapshot.put("Name", "name", std::move(name));
  return snapshot;
}

EntitySnapshot lightEntity(std::string_view kind, std::string name) {
  EntitySnapshot snapshot = emptyEntity(std::move(name));
  snapshot.components.push_back(defaults("Light"));
  snapshot.put("Light", "kind", scene::Word{std::string(kind)});
  // Spheres and discs of radius 0 emit nothing.
  if (kind == "sphere" || kind == "disc") snapshot.put("Light", "radius", 0.1f);
  return snapshot;
}

EntitySnapshot cameraEntity(std::string name) {
  EntitySnapshot snapshot = emptyEntity(std::move(name));
  snapshot.components.push_back(defaults("Camera"));
  return snapshot;
}

}  // namespace lambent::editor
