#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "baker/import/check.hpp"

namespace lambent::baker {

const nlohmann::json& memberOf(const nlohmann::json& owner, std::initializer_list<const char*> keys) {
  static const nlohmann::json kNone;
  const nlohmann::json* place = &owner;
  for (const char* key : keys) {
    const auto found = place->is_object() ? place->find(key) : place->end();
    if (found == place->end()) return kNone;
    place = &*found;
  }
  return *place;
}

namespace {

using nlohmann::json;

// Returns whether it is worth a word that one number counts as another. Shares may exceed 1 by rounding.
bool differs(double was, double now) {
  return std::abs(now - was) > 1e-4 * std::max(1.0, std::abs(now));
}

// Other readers of JSON do not distinguish 24.0 from 24, so some exporters write counts that way.
void makeWhole(json& value) {
  constexpr double kLargest = 9007199254740992.0;  // 2^53
  if (!value.is_number_float()) return;
  const double number = value.get<double>();
  if (number >= 0.0 && number <= kLargest && !std::signbit(number) && number == std::floor(number))
    value = static_cast<std::uint64_t>(number);
}

// Returns whether -1 under this key is meant to say that there is no object.
bool isIndex(std::string_view key) {
  constexpr std::array<std::string_view, 11> kKeys{"mesh",    "camera",     "skin",    "material",
                                                   "indices", "source",     "sampler", "light",
                                                   "scene",   "bufferView", "node"};
  return std::ranges::find(kKeys, key) != kKeys.end();
}

// Returns what is wrong with a member that has to be taken out, or an empty string.
std::string faultOf(const std::string& key, const json& value) {
  if (value.is_null()) return "is null";
  if (isIndex(key) && value.is_number_integer() && value.get<std::int64_t>() == -1) return "is -1";
  if (key == "extensions" && !value.is_object()) return "is not an object";
  if (key == "name" && !value.is_string()) return "is not a string";
  return {};
}

void mendTree(json& value, const std::string& place, std::vector<std::string>& warnings) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      if (value[i].is_structured())
        mendTree(value[i], fmt::format("{} {}", place, i), warnings);
      else
        makeWhole(value[i]);
    return;
  }
  for (auto item = value.begin(); item != value.end();) {
    const std::string& key = item.key();
    // Languages whose objects are lists write an empty one as [].
    if (key == "extensions" && *item == json::array()) *item = json::object();
    if (const std::string fault = faultOf(key, *item); !fault.empty() && key != "extras") {
      warnings.push_back(fmt::format("{}: {} {} and is left out", place, key, fault));
      item = value.erase(item);
      continue;
    }
    // `extras` may hold anything.
    if (item->is_structured() && key != "extras")
      mendTree(*item, place.empty() ? key : place + " " + key, warnings);
    else
      makeWhole(*item);
    ++item;
  }
}

}  // namespace

bool isFiniteNumber(const nlohmann::json& value) {
  return value.is_number() && std::isfinite(value.get<float>());
}

nlohmann::json* Entry::find(const char* key) const {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found == json.end() ? nullptr : &*found;
}

void Entry::leaveOut(const char* key, const std::string& why) const {
  warn(fmt::format("{} {} and is left out", key, why));
  json.erase(key);
}

std::optional<Entry> Entry::object(const char* key) const {
  nlohmann::json* member = find(key);
  if (member == nullptr) return std::nullopt;
  if (member->is_object()) return Entry{*member, fmt::format("{}: {}", name, key), document};
  leaveOut(key, "is not an object");
  return std::nullopt;
}

std::optional<Entry> Entry::extension(const char* key) const {
  const auto extensions = object("extensions");
  return extensions ? extensions->object(key) : std::nullopt;
}

std::optional<Entry> Entry::ours() const {
  if (!memberOf(json, {"extras", "lambent"}).is_object()) return std::nullopt;
  return Entry{json["extras"]["lambent"], name + ": extras: lambent", document};
}

void Entry::clamp(const char* key, double least, double most) const {
  nlohmann::json* value = find(key);
  if (value == nullptr) return;
  if (!isFiniteNumber(*value)) return leaveOut(key, fmt::format("is {}, no number,", value->dump()));
  const double was = value->get<double>(), now = std::clamp(was, least, most);
  if (now == was) return;
  if (differs(was, now)) warn(fmt::format("{} is {}, which counts as {}", key, value->dump(), now));
  *value = now;
}

void Entry::clampAll(const char* key, std::size_t count, double least, double most) const {
  nlohmann::json* values = find(key);
  if (values == nullptr) return;
  if (!values->is_array() || values->size() != count || !std::ranges::all_of(*values, isFiniteNumber))
    return leaveOut(key, fmt::format("is not {} finite numbers", count));
  const std::string was = values->dump();
  bool changed = false;
  for (nlohmann::json& value : *values) {
    const double number = value.get<double>(), now = std::clamp(number, least, most);
    changed |= differs(number, now);
    if (now != number) value = now;
  }
  if (changed) warn(fmt::format("{} is {}, which counts as {}", key, was, values->dump()));
}

void Entry::keepWhole(const char* key, std::uint64_t most) const {
  const nlohmann::json* value = find(key);
  if (value != nullptr && (!value->is_number_unsigned() || value->get<std::uint64_t>() > most))
    leaveOut(key, fmt::format("is {}", value->dump()));
}

void mendMembers(const Entry& root) {
  // Nothing reads the bounds of accessors, which are often wrong.
  root.forEach("accessors", "accessor", [](const Entry& accessor) {
    accessor.json.erase("min");
    accessor.json.erase("max");
  });
  mendTree(root.json, "", root.document.warnings);
}

// Mends primitives and animations. Bytes are not read here: what is out of bounds is refused by the checks.

namespace {

// Attributes that may be missing, with the types that they may have.
struct Optional {
  const char* semantic;
  std::array<const char*, 2> types;
};
constexpr std::array kOptional = {Optional{"NORMAL", {"VEC3", "VEC3"}}, Optional{"TANGENT", {"VEC4", "VEC4"}},
                                  Optional{"TEXCOORD_0", {"VEC2", "VEC2"}},
                                  Optional{"TEXCOORD_1", {"VEC2", "VEC2"}},
                                  Optional{"COLOR_0", {"VEC3", "VEC4"}}};

bool isRead(std::string_view semantic) {
  return semantic == "POSITION" || semantic.starts_with("JOINTS_") || semantic.starts_with("WEIGHTS_") ||
         std::ranges::any_of(kOptional, [&](const Optional& row) { return row.semantic == semantic; });
}

// Returns the accessor that a member names, if there is one.
json* accessorOf(const Entry& root, const json& owner, const char* key) {
  const json& number = memberOf(owner, {key});
  if (!number.is_number_unsigned() || number.get<std::size_t>() >= root.list("accessors").size())
    return nullptr;
  return &root.json["accessors"][number.get<std::size_t>()];
}

bool isEmpty(const json* accessor) {
  return accessor != nullptr && accessor->contains("count") && (*accessor)["count"] == 0;
}

// glTF has one meaning for colors in integers: shares of the largest one.
void flagColors(const Entry& primitive, const json& attributes, json& colors) {
  constexpr int kFloat = 5126;
  if (colors.value("componentType", json()) == kFloat || colors.value("normalized", json()) == true) return;
  primitive.warn(fmt::format("its colors in accessor {} are not flagged as normalized but are read so",
                             attributes["COLOR_0"].dump()));
  colors["normalized"] = true;
}

void mendAttributes(const Entry& root, const Entry& primitive, json& attributes) {
  for (auto item = attributes.begin(); item != attributes.end();)
    item = isRead(item.key()) ? std::next(item) : attributes.erase(item);
  const json* positions = accessorOf(root, attributes, "POSITION");
  if (positions == nullptr) return;
  const json count = positions->value("count", json());
  for (const Optional& row : kOptional) {
    json* accessor = accessorOf(root, attributes, row.semantic);
    if (accessor == nullptr) continue;
    const json type = accessor->value("type", json()), here = accessor->value("count", json());
    if (std::ranges::find(row.types, type) == row.types.end() || here != count) {
      primitive.warn(fmt::format("{} has {} elements of {} for {} vertices and is left out", row.semantic,
                                 here.dump(), type.dump(), count.dump()));
      attributes.erase(row.semantic);
    } else if (std::string_view(row.semantic) == "COLOR_0") {
      flagColors(primitive, attributes, *accessor);
    }
  }
}

void mendPrimitive(const Entry& root, const Entry& primitive) {
  const auto attributes = primitive.object("attributes");
  if (attributes) mendAttributes(root, primitive, attributes->json);
  const bool empty = attributes && (isEmpty(accessorOf(root, attributes->json, "POSITION")) ||
                                    isEmpty(accessorOf(root, primitive.json, "indices")));
  // The conversion says that it has no geometry.
  if (empty)
    for (const char* key : {"indices", "targets", "extensions"}) primitive.json.erase(key);
  if (empty || !attributes) primitive.json["attributes"] = json::object();
}

void mendChannels(const Entry& animation) {
  if (animation.list("channels").empty()) return;
  std::size_t number = 0;
  std::erase_if(animation.json["channels"].get_ref<json::array_t&>(), [&](const json& channel) {
    const char* lacks = !memberOf(channel, {"target"}).is_object() ? "target"
                        : memberOf(channel, {"sampler"}).is_null() ? "sampler"
                                                                   : nullptr;
    if (lacks) animation.warn(fmt::format("channel {} has no {} and is left out", number, lacks));
    ++number;
    return lacks != nullptr;
  });
}

}  // namespace

void mendPrimitives(const Entry& root) {
  root.forEach("accessors", "accessor", [](const Entry& accessor) {
    if (memberOf(accessor.json, {"sparse", "count"}) == 0) accessor.leaveOut("sparse", "replaces nothing");
  });
  root.forEach("bufferViews", "bufferView", [](const Entry& view) {
    if (memberOf(view.json, {"byteStride"}) == 0) view.leaveOut("byteStride", "is 0");
  });
  root.forEach("meshes", "mesh", [&](const Entry& mesh) {
    mesh.forEach("primitives", mesh.name + ", primitive",
                 [&](const Entry& primitive) { mendPrimitive(root, primitive); });
  });
}

void mendAnimations(const Entry& root) {
  root.forEach("animations", "animation", [](const Entry& animation) {
    animation.forEach("samplers", animation.name + ", sampler", [](const Entry& sampler) {
      const json* word = sampler.find("interpolation");
      if (word != nullptr && *word != "LINEAR" && *word != "STEP" && *word != "CUBICSPLINE")
        sampler.leaveOut("interpolation", fmt::format("is {}", word->dump()));
    });
    mendChannels(animation);
  });
}

}  // namespace lambent::baker
