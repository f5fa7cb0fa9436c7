#include "editor/document/actions.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "editor/document/value_json.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

// Returns snapshots of the entities and their descendants, parents first. Errors: those of duplicate().
Result<std::vector<EntitySnapshot>> copiesOf(const Document& document,
                                             std::span<const ecs::Entity> entities) {
  const ecs::Registry& registry = document.registry();
  std::map<ecs::Entity, const scene::DrawItem*> draws;
  for (auto [entity, draw] : registry.view<scene::DrawItem>()) draws[draw.node] = &draw;
  std::vector<EntitySnapshot> copies;
  for (const ecs::Entity entity : withDescendants(registry, {entities.begin(), entities.end()})) {
    if (draws.contains(entity))
      return fail(document.nameOf(entity), "shows a mesh of its bundle, which cannot be copied alone",
                  "put the bundle into the world a second time");
    EntitySnapshot copy = takeSnapshot(document, entity);
    std::erase_if(copy.components, [](const ComponentValues& part) { return !part.component->addable; });
    if (copy.find("Transform", "translation") == nullptr)
      return fail(document.nameOf(entity), "belongs to a bundle or to the world itself",
                  "choose lights, cameras or empty nodes");
    if (copy.find("Name", "name") == nullptr)
      copy.components.insert(copy.components.begin(), emptyEntity("copy").components.front());
    copies.push_back(std::move(copy));
  }
  return copies;
}

// Creates entities from the snapshots as one step of the history. Returns those whose parent is not among
// them.
Result<std::vector<ecs::Entity>> makeCopies(Document& document, History& history,
                                            std::vector<EntitySnapshot> copies, std::string name) {
  // Every copy gets a new id, and its parent is renamed if it is a copy, too.
  std::map<StableId, StableId> renamed;
  for (const EntitySnapshot& copy : copies) renamed[copy.id] = document.newId();
  std::vector<StableId> tops;
  history.begin(std::move(name));
  for (EntitySnapshot& copy : copies) {
    copy.id = renamed[copy.id];
    const auto parent = renamed.find(copy.parent);
    if (parent != renamed.end())
      copy.parent = parent->second;
    else
      tops.push_back(copy.id);
    if (const Result<ecs::Entity> made = history.create(copy); !made) {
      history.cancel();
      return failAgain(made.error());
    }
  }
  history.commit();
  std::vector<ecs::Entity> entities;
  for (const StableId id : tops) entities.push_back(document.find(id));
  return entities;
}

// Returns "ball 2" for "ball" and "ball 1", or the next free number.
std::string nextName(const Document& document, const std::string& name) {
  std::string stem = name;
  while (!stem.empty() && stem.back() >= '0' && stem.back() <= '9') stem.pop_back();
  if (stem.empty() || stem.size() == name.size() || stem.back() != ' ') stem = name + " ";
  std::vector<std::string> taken;
  for (auto [entity, there] : std::as_const(document.registry()).view<scene::Name>())
    taken.push_back(there.value);
  for (int number = 2;; ++number) {
    std::string next = stem + std::to_string(number);
    if (std::find(taken.begin(), taken.end(), next) == taken.end()) return next;
  }
}

}  // namespace

Result<std::vector<ecs::Entity>> duplicate(Document& document, History& history,
                                           std::span<const ecs::Entity> entities) {
  for (const ecs::Entity entity : entities) document.adopt(entity);
  Result<std::vector<EntitySnapshot>> copies = copiesOf(document, entities);
  if (!copies) return failAgain(copies.error());
  history.begin("duplicate of " + entitiesName(document, entities));
  const Result<std::vector<ecs::Entity>> made = makeCopies(document, history, std::move(*copies), "copies");
  if (!made) {
    history.cancel();
    return made;
  }
  for (const ecs::Entity entity : *made) {
    if (const Result<void> named =
            history.setField(entity, "Name", "name", nextName(document, document.nameOf(entity)));
        !named) {
      history.cancel();
      return failAgain(named.error());
    }
  }
  history.commit();
  return made;
}

scene::Value defaultValue(const Document& document, const Baseline& baseline, ecs::Entity entity,
                          const scene::FieldInfo& field) {
  if (!document.created(entity)) {
    if (const auto value = baseline.value(document.idOf(entity), field)) return *value;
  }
  return field.default_value;
}

bool isDefault(const Document& document, const Baseline& baseline, ecs::Entity entity,
               const scene::FieldInfo& field) {
  return scene::sameBits(field.get(document.registry(), entity),
                         defaultValue(document, baseline, entity, field));
}

Result<void> resetToDefault(Document& document, History& history, const Baseline& baseline,
                            std::span<const ecs::Entity> entities, std::string_view component,
                            std::string_view field) {
  const scene::ComponentInfo* info = scene::findComponent(component);
  if (!info) return fail(fmt::format("component \"{}\"", component), "is not known");
  if (!field.empty() && !info->field(field)) return failAgain(scene::findField(component, field).error());
  std::vector<FieldEdit> edits;
  for (const ecs::Entity entity : entities) {
    if (!info->has(document.registry(), entity)) continue;
    for (const scene::FieldInfo& row : info->fields) {
      if (field.empty() || row.name == field)
        edits.push_back({entity, info->name, row.name, defaultValue(document, baseline, entity, row)});
    }
  }
  // A value of a bundle may lie outside the field's range and is still its default.
  return history.setFields(
      edits,
      fmt::format("reset of {} of {}", field.empty() ? component : field, entitiesName(document, entities)),
      /*in_range=*/false);
}

namespace {

constexpr const char* kMark = "lambent_clip";
constexpr std::uint64_t kClipVersion = 1;
const std::string kSubject = "clipboard";

Result<Json> componentJson(const ComponentValues& part) {
  Json fields = Json::object();
  for (std::size_t i = 0; i < part.values.size(); ++i) {
    Result<Json> value = valueJson(part.values[i]);
    if (!value)
      return fail(fmt::format("{}.{}", part.component->name, part.component->fields[i].name),
                  value.error().problem, value.error().hint);
    fields[std::string(part.component->fields[i].name)] = std::move(*value);
  }
  return fields;
}

const scene::ComponentInfo& componentAt(const Place& place, const std::string& name) {
  const scene::ComponentInfo* info = scene::findComponent(name);
  if (!info) place.fault("is a component that this version does not know");
  return *info;
}

// A field that the text omits gets its default.
ComponentValues readComponent(const Place& place, const scene::ComponentInfo& info) {
  for (const auto& [name, value] : place.members()) {
    if (!info.field(name)) value.fault("is a field that this version does not know");
  }
  ComponentValues part{&info, {}};
  for (const scene::FieldInfo& field : info.fields) {
    const std::string name(field.name);
    part.values.push_back(place.has(name) ? place.at(name).value(field) : field.default_value);
  }
  return part;
}

StableId readId(const Place& place) {
  const auto id = parseId(place.text());
  if (!id) place.fault("is not 16 hexadecimal digits");
  return *id;
}

Result<ReadJson> readClip(std::string_view text, const char* part) {
  Result<ReadJson> json = parseJson(text, kSubject);
  if (!json || !json->is_object() || !json->contains(kMark))
    return fail(kSubject, "holds nothing that was copied here", "copy a component or entities first");
  const ReadJson& version = (*json)[kMark];
  if (!version.is_number_unsigned() || version.get<std::uint64_t>() > kClipVersion)
    return fail(kSubject, "was copied by a newer version", "update this program");
  if (!json->contains(part)) return fail(kSubject, fmt::format("holds no {}", part), "copy one first");
  return json;
}

tl::unexpected<Error> asError(const JsonFault& fault) {
  return fail(kSubject + ": " + fault.place, fault.problem, fault.hint);
}

}  // namespace

Result<std::string> copyComponent(const Document& document, ecs::Entity entity, std::string_view component) {
  const scene::ComponentInfo* info = scene::findComponent(component);
  if (!info || !info->has(document.registry(), entity))
    return fail(document.nameOf(entity), fmt::format("has no {}", component));
  Result<Json> fields = componentJson(componentValues(document.registry(), entity, *info));
  if (!fields) return failAgain(fields.error());
  Json clip = Json::object();
  clip[kMark] = kClipVersion;
  clip["component"] = std::string(component);
  clip["fields"] = std::move(*fields);
  return clip.dump(1, ' ', false, Json::error_handler_t::replace);
}

Result<std::string> copyEntities(const Document& document, std::span<const ecs::Entity> entities) {
  const Result<std::vector<EntitySnapshot>> copies = copiesOf(document, entities);
  if (!copies) return failAgain(copies.error());
  Json list = Json::array();
  for (const EntitySnapshot& copy : *copies) {
    Json entry = Json::object();
    entry["id"] = idText(copy.id);
    if (copy.parent != kNoId) entry["parent"] = idText(copy.parent);
    for (const ComponentValues& part : copy.components) {
      Result<Json> fields = componentJson(part);
      if (!fields) return failAgain(fields.error());
      entry["components"][std::string(part.component->name)] = std::move(*fields);
    }
    list.push_back(std::move(entry));
  }
  Json clip = Json::object();
  clip[kMark] = kClipVersion;
  clip["entities"] = std::move(list);
  return clip.dump(1, ' ', false, Json::error_handler_t::replace);
}

Pasted peekClip(std::string_view text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains(kMark)) return Pasted::Nothing;
  return json.contains("component")  ? Pasted::Component
         : json.contains("entities") ? Pasted::Entities
                                     : Pasted::Nothing;
}

Result<void> pasteComponent(Document& document, History& history, std::span<const ecs::Entity> entities,
                            std::string_view text) {
  const Result<ReadJson> clip = readClip(text, "component");
  if (!clip) return failAgain(clip.error());
  ComponentValues part;
  try {
    const Place top(*clip, "");
    part = readComponent(top.at("fields"), componentAt(top.at("component"), top.at("component").text()));
  } catch (const JsonFault& fault) {
    return asError(fault);
  }
  const scene::ComponentInfo& info = *part.component;
  history.begin(fmt::format("paste of {} onto {}", info.name, entitiesName(document, entities)));
  std::vector<FieldEdit> edits;
  for (const ecs::Entity entity : entities) {
    if (!info.has(document.registry(), entity)) {
      if (const Result<void> added = history.addComponent(entity, info.name); !added) {
        history.cancel();
        return added;
      }
    }
    for (std::size_t i = 0; i < part.values.size(); ++i)
      edits.push_back({entity, info.name, info.fields[i].name, part.values[i]});
  }
  if (const Result<void> set = history.setFields(edits); !set) {
    history.cancel();
    return set;
  }
  history.commit();
  return {};
}

Result<std::vector<ecs::Entity>> pasteEntities(Document& document, History& history, ecs::Entity parent,
                                               std::string_view text) {
  const Result<ReadJson> clip = readClip(text, "entities");
  if (!clip) return failAgain(clip.error());
  std::vector<EntitySnapshot> copies;
  try {
    for (const Place& entry : Place(*clip, "").at("entities").items()) {
      EntitySnapshot copy;
      copy.id = readId(entry.at("id"));
      if (entry.has("parent")) copy.parent = readId(entry.at("parent"));
      for (const auto& [name, place] : entry.at("components").members()) {
        const scene::ComponentInfo& info = componentAt(place, name);
        if (!info.addable) place.fault("cannot be made by hand: it comes with a bundle");
        copy.components.push_back(readComponent(place, info));
      }
      if (std::any_of(copies.begin(), copies.end(), [&](const auto& other) { return other.id == copy.id; }))
        entry.at("id").fault("stands there twice");
      copies.push_back(std::move(copy));
    }
  } catch (const JsonFault& fault) {
    return asError(fault);
  }
  // A copy whose parent was not copied goes below the entity that it is pasted to.
  const StableId below = parent ? document.adopt(parent) : kNoId;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const bool inside = std::any_of(copies.begin(), copies.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&](const auto& other) { return other.id == copies[i].parent; });
    if (!inside) copies[i].parent = below;
  }
  return makeCopies(document, history, std::move(copies), "paste");
}

}  // namespace lambent::editor
