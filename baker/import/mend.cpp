#include "baker/import/mend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace lambent::baker {
namespace {

using nlohmann::json;

bool isFiniteNumber(const json& value) {
  return value.is_number() && std::isfinite(value.get<float>());
}

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

void Entry::leaveOut(const char* key, const std::string& why) const {
  warn(fmt::format("{} {} and is left out", key, why));
  json.erase(key);
}

std::optional<Entry> Entry::object(const char* key) const {
  nlohmann::json* member = find(key);
  if (member == nullptr) return std::nullopt;
  if (member->is_object()) return Entry{*member, fmt::format("{}: {}", name, key), warnings};
  leaveOut(key, "is not an object");
  return std::nullopt;
}

std::optional<Entry> Entry::extension(const char* key) const {
  const auto extensions = object("extensions");
  return extensions ? extensions->object(key) : std::nullopt;
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
  forEachEntry(root, "accessors", "accessor", [](const Entry& accessor) {
    accessor.json.erase("min");
    accessor.json.erase("max");
  });
  if (root.json.is_object()) mendTree(root.json, "", root.warnings);
}

}  // namespace lambent::baker
