#include "editor/document/snapshot.hpp"

#include "runtime/scene/components.hpp"

namespace lambent::editor {

const scene::Value* EntitySnapshot::find(std::string_view component, std::string_view field) const {
  for (const ComponentValues& part : components) {
    if (part.component->name != component) continue;
    for (std::size_t i = 0; i < part.values.size(); ++i) {
      if (part.component->fields[i].name == field) return &part.values[i];
    }
  }
  return nullptr;
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

std::size_t bytesOf(const scene::Value& value) {
  std::size_t bytes = sizeof(value);
  if (const auto* text = std::get_if<std::string>(&value)) bytes += text->size();
  return bytes;
}

std::size_t bytesOf(const EntitySnapshot& snapshot) {
  std::size_t bytes = sizeof(snapshot);
  for (const ComponentValues& part : snapshot.components) {
    bytes += sizeof(part);
    for (const scene::Value& value : part.values) bytes += bytesOf(value);
  }
  return bytes;
}

namespace {

// Returns the defaults of a component, with another value for one field.
ComponentValues defaults(std::string_view component, std::string_view field = {}, scene::Value value = {}) {
  ComponentValues part{scene::findComponent(component), {}};
  for (const scene::FieldInfo& info : part.component->fields)
    part.values.push_back(info.name == field ? value : info.default_value);
  return part;
}

}  // namespace

EntitySnapshot emptyEntity(std::string name) {
  return {kNoId, kNoId, {defaults("Name", "name", std::move(name)), defaults("Transform")}};
}

EntitySnapshot lightEntity(std::string_view kind, std::string name) {
  EntitySnapshot snapshot = emptyEntity(std::move(name));
  ComponentValues light = defaults("Light", "kind", scene::Word{std::string(kind)});
  // Spheres and discs of radius 0 emit nothing.
  for (std::size_t i = 0; i < light.values.size(); ++i) {
    if (light.component->fields[i].name == "radius" && (kind == "sphere" || kind == "disc"))
      light.values[i] = 0.1f;
  }
  snapshot.components.push_back(std::move(light));
  return snapshot;
}

EntitySnapshot cameraEntity(std::string name) {
  EntitySnapshot snapshot = emptyEntity(std::move(name));
  snapshot.components.push_back(defaults("Camera"));
  return snapshot;
}

}  // namespace lambent::editor
