#include "editor/document/world_file.hpp"

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "editor/document/value_json.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/scene/instantiate.hpp"
#include "runtime/scene/reflection.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {
namespace {

constexpr const char* kWorldFileMark = "lambent_world";  // the key of the version

const scene::ComponentInfo& environmentInfo() {
  return *scene::findComponent("Environment");
}

// ---- Reading.

class WorldReader {
 public:
  explicit WorldReader(const ReadJson& document) : top_(document, "") {}

  WorldFile run() {
    readVersion();
    if (top_.has("bundles")) readBundles(top_.at("bundles"));
    if (top_.has("environment")) readEnvironment(top_.at("environment"));
    if (top_.has("settings")) world_.state.settings = top_.at("settings").table();
    if (top_.has("view")) world_.state.view = top_.at("view").table();
    if (top_.has("entities")) readEntities(top_.at("entities"));
    top_.tellUnknown({kWorldFileMark, "bundles", "environment", "settings", "view", "entities"},
                     world_.notices);
    return std::move(world_);
  }

 private:
  void readVersion() {
    if (!top_.has(kWorldFileMark))
      throw JsonFault{kWorldFileMark, "is missing", "this is no world file; save one with the editor"};
    const std::uint64_t version = top_.at(kWorldFileMark).count(~std::uint32_t{0});
    if (version == 0) top_.at(kWorldFileMark).fault("is 0, and there is no such version");
    if (version > kWorldFileVersion)
      top_.at(kWorldFileMark)
          .fault(fmt::format("is version {}; this program reads up to {}", version, kWorldFileVersion),
                 "open it with a newer one");
  }

  void readBundles(const Place& list) {
    std::set<std::pair<std::string, std::uint32_t>> seen;
    for (const Place& place : list.items()) {
      BundleEntry entry;
      entry.path = place.at("path").text();
      if (entry.path.empty()) place.at("path").fault("is empty", "name a bundle file");
      entry.id = place.has("id") ? place.at("id").text() : entry.path;
      if (entry.id.empty()) place.at("id").fault("is empty", "leave it out to take the path");
      if (place.has("instance"))
        entry.instance = static_cast<std::uint32_t>(place.at("instance").count(~std::uint32_t{0}));
      if (place.has("source")) entry.source = place.at("source").text();
      if (place.has("bake_options")) entry.bake_options = place.at("bake_options").table();
      place.tellUnknown({"path", "id", "instance", "source", "bake_options"}, world_.notices);
      if (!seen.emplace(entry.id, entry.instance).second)
        place.fault(fmt::format("is \"{}\", instance {}, for the second time", entry.id, entry.instance),
                    "give it another instance number");
      world_.state.bundles.push_back(std::move(entry));
    }
  }

  std::vector<std::string> readLights(const Place& environment, const char* key) {
    if (!environment.has(key)) return {};
    std::vector<std::string> words;
    for (const Place& place : environment.at(key).items()) {
      const std::string word = place.text();
      const Result<spec::Light> light = spec::parseLight(word);
      if (!light) place.fault(light.error().problem, light.error().hint);
      if (!spec::localLights({&*light, 1}).empty())
        place.fault("is a light that stands in the scene", "make it an entity with a Light");
      words.push_back(word);
    }
    return words;
  }

  void readEnvironment(const Place& place) {
    world_.state.lights = readLights(place, "lights");
    world_.state.fade_lights = readLights(place, "fade_lights");
    if (place.has("exposure")) world_.state.exposure_ev = place.at("exposure").number();
    if (place.has("key_edits"))
      for (const Place& edit : place.at("key_edits").items()) {
        const std::string word = edit.text();
        if (const auto parsed = spec::parseKeyEdit(word); !parsed)
          edit.fault(parsed.error().problem, parsed.error().hint);
        world_.state.key_edits.push_back(word);
      }
    std::set<std::string> known{"lights", "fade_lights", "key_edits", "exposure"};
    // The table of components is used, so that a new field needs no change here.
    ecs::Registry scratch;
    const ecs::Entity entity = scratch.create();
    scratch.emplace<scene::EnvironmentComponent>(entity);
    for (const scene::FieldInfo& field : environmentInfo().fields) {
      const std::string name(field.name);
      known.insert(name);
      if (place.has(name)) field.restore(scratch, entity, place.at(name).value(field));
    }
    world_.environment = scratch.get<scene::EnvironmentComponent>(entity);
    place.tellUnknown(known, world_.notices);
  }

  void readEntities(const Place& table) {
    for (const auto& [key, place] : table.members()) {
      const auto id = parseId(key);
      if (!id || *id == kNoId) place.fault("has a name that is not 16 hexadecimal digits");
      EntityOverride entry;
      entry.id = *id;
      if (place.has("created")) entry.created = place.at("created").flag();
      if (place.has("name")) entry.name = place.at("name").text();
      if (place.has("parent")) entry.parent = readParent(place.at("parent"));
      if (place.has("components")) readComponents(place.at("components"), entry);
      place.tellUnknown({"created", "name", "parent", "components"}, world_.notices);
      for (const FieldOverride& field : entry.fields) {
        if (entry.created && field.field->component == "Name" && field.field->name == "name")
          entry.name = std::get<std::string>(field.value);
      }
      world_.entities.push_back(std::move(entry));
    }
    std::sort(world_.entities.begin(), world_.entities.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
  }

  StableId readParent(const Place& place) {
    if (place.json().is_null()) return kNoId;
    const auto id = parseId(place.text());
    if (!id || *id == kNoId) place.fault("is not 16 hexadecimal digits, nor null for the world");
    return *id;
  }

  void readComponents(const Place& components, EntityOverride& entry) {
    std::set<std::string> known_components;
    // The order is that of the table, whatever the file's is.
    for (const scene::ComponentInfo& info : scene::components()) {
      const std::string component(info.name);
      known_components.insert(component);
      if (!components.has(component)) continue;
      const Place place = components.at(component);
      if (entry.created && !info.addable) place.fault("cannot be made by hand: it comes with a bundle");
      if (entry.created) entry.components.push_back(&info);
      std::set<std::string> known;
      for (const scene::FieldInfo& field : info.fields) {
        const std::string name(field.name);
        known.insert(name);
        if (place.has(name)) entry.fields.push_back({&field, place.at(name).value(field)});
      }
      place.tellUnknown(known, world_.notices);
    }
    components.tellUnknown(known_components, world_.notices);
  }

  Place top_;
  WorldFile world_;
};

// ---- Writing.

// Writes lists of numbers, and single values, on one line and everything else on several lines.
void write(std::string& out, const Json& value, std::size_t depth) {
  const bool flat = value.is_primitive() || value.empty() ||
                    (value.is_array() && std::all_of(value.begin(), value.end(),
                                                     [](const Json& part) { return part.is_number(); }));
  if (flat) {
    out += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const std::string inner(2 * (depth + 1), ' ');
  out += value.is_array() ? "[" : "{";
  bool first = true;
  for (const auto& [key, part] : value.items()) {
    out += first ? "\n" : ",\n";
    first = false;
    out += inner;
    if (value.is_object()) out += Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    write(out, part, depth + 1);
  }
  out += '\n';
  out.append(2 * depth, ' ');
  out += value.is_array() ? ']' : '}';
}

Json table(const std::map<std::string, std::string>& values) {
  Json json = Json::object();
  for (const auto& [key, value] : values) json[key] = value;
  return json;
}

Json bundleJson(const BundleEntry& entry) {
  Json json = Json::object();
  json["path"] = entry.path;
  json["id"] = entry.id;
  json["instance"] = entry.instance;
  if (!entry.source.empty()) json["source"] = entry.source;
  if (!entry.bake_options.empty()) json["bake_options"] = table(entry.bake_options);
  return json;
}

Result<Json> entityJson(const EntityOverride& entry) {
  Json json = Json::object();
  if (entry.created)
    json["created"] = true;
  else if (!entry.name.empty())
    json["name"] = entry.name;
  if (entry.parent) json["parent"] = *entry.parent == kNoId ? Json(nullptr) : Json(idText(*entry.parent));
  Json components = Json::object();
  for (const scene::ComponentInfo* component : entry.components)
    components[std::string(component->name)] = Json::object();
  for (const FieldOverride& field : entry.fields) {
    // A value that the reader would refuse is not written.
    Result<Json> value = valueJson(field.value);
    const Result<void> good = field.field->check(field.value);
    if (!value || !good) {
      const Error& error = good ? value.error() : good.error();
      return fail(fmt::format("{}.{} of {}", field.field->component, field.field->name, entry.name),
                  error.problem, "change it before saving");
    }
    components[std::string(field.field->component)][std::string(field.field->name)] = std::move(*value);
  }
  if (!components.empty()) json["components"] = std::move(components);
  return json;
}

Result<Json> environmentJson(const WorldFile& world) {
  Json json = Json::object();
  json["lights"] = world.state.lights;
  json["fade_lights"] = world.state.fade_lights;
  if (!world.state.key_edits.empty()) json["key_edits"] = world.state.key_edits;
  ecs::Registry scratch;
  const ecs::Entity entity = scratch.create();
  scratch.emplace<scene::EnvironmentComponent>(entity, world.environment);
  for (const scene::FieldInfo& field : environmentInfo().fields) {
    Result<Json> value = valueJson(field.get(scratch, entity));
    if (!value)
      return fail(fmt::format("environment.{}", field.name), value.error().problem, "set it to a number");
    json[std::string(field.name)] = std::move(*value);
  }
  if (world.state.exposure_ev) {
    Result<Json> exposure = valueJson(*world.state.exposure_ev);
    if (!exposure) return fail("environment.exposure", exposure.error().problem, "set it to a number");
    json["exposure"] = std::move(*exposure);
  }
  return json;
}

}  // namespace

Result<WorldFile> parseWorld(std::string_view text, const std::string& subject) {
  const Result<ReadJson> json = parseJson(text, subject);
  if (!json) return failAgain(json.error());
  if (!json->is_object()) return fail(subject, "is no world file", "save one with the editor");
  try {
    return WorldReader(*json).run();
  } catch (const JsonFault& fault) {
    return fail(subject, fault.place + " " + fault.problem, fault.hint);
  }
}

Result<std::string> worldText(const WorldFile& world) {
  Json json = Json::object();
  json[kWorldFileMark] = kWorldFileVersion;
  json["bundles"] = Json::array();
  for (const BundleEntry& entry : world.state.bundles) json["bundles"].push_back(bundleJson(entry));
  Result<Json> environment = environmentJson(world);
  if (!environment) return failAgain(environment.error());
  json["environment"] = std::move(*environment);
  json["settings"] = table(world.state.settings);
  if (!world.state.view.empty()) json["view"] = table(world.state.view);
  // The entities are sorted by id already. They are appended, because a look-up in an ordered object is
  // linear.
  Json::object_t entities;
  for (const EntityOverride& entry : world.entities) {
    Result<Json> entity = entityJson(entry);
    if (!entity) return failAgain(entity.error());
    entities.push_back({idText(entry.id), std::move(*entity)});
  }
  json["entities"] = std::move(entities);
  std::string out;
  write(out, json, 0);
  return out + "\n";
}

Result<WorldFile> loadWorldFile(const std::filesystem::path& path) {
  const Result<std::string> text = readTextFile(path);
  if (!text) return failAgain(text.error());
  return parseWorld(*text, path.string());
}

Result<void> saveWorldFile(const std::filesystem::path& path, const WorldFile& world) {
  const Result<std::string> text = worldText(world);
  if (!text) return fail(path.string(), text.error().line());
  Result<AtomicFile> file = AtomicFile::open(path);
  if (!file) return failAgain(file.error());
  if (const Result<void> written = file->write(*text); !written) return written;
  return file->commit();
}

WorldFile captureWorld(Document& document, const Baseline& baseline, const Overrides& awaited) {
  WorldFile world;
  world.state = document.world();
  world.entities = captureOverrides(document, baseline);
  for (auto [entity, environment] : std::as_const(document.registry()).view<scene::EnvironmentComponent>())
    world.environment = environment;
  for (const EntityOverride& edit : awaited)
    if (!document.find(edit.id)) world.entities.push_back(edit);
  std::ranges::sort(world.entities, {}, &EntityOverride::id);
  return world;
}

ApplyReport applyWorld(Document& document, const WorldFile& world) {
  document.setWorld(world.state);
  ecs::Registry& registry = document.registry();
  bool found = false;
  for (auto [entity, environment] : std::as_const(registry).view<scene::EnvironmentComponent>()) {
    registry.edit<scene::EnvironmentComponent>(entity) = world.environment;
    document.adopt(entity);
    found = true;
  }
  if (!found) document.adopt(scene::addEnvironment(registry, world.environment));
  return applyOverrides(document, world.entities);
}

}  // namespace lambent::editor
