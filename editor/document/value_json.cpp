#include "editor/document/value_json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

namespace lambent::editor {

Json numberJson(float value) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof(digits) - 1, value);
  if (error == std::errc{}) {
    double decimal = 0.0;
    std::from_chars(digits, end, decimal);
    if (static_cast<float>(decimal) == value) return decimal;
  }
  return static_cast<double>(value);
}

Result<Json> valueJson(const scene::Value& value) {
  const auto numbers = [](const auto& list) -> Result<Json> {
    Json json = Json::array();
    for (const float number : list) {
      if (!std::isfinite(number)) return fail("a number", "is not finite", "JSON has no such number");
      json.push_back(numberJson(number));
    }
    return json;
  };
  switch (scene::kindOf(value)) {
    case scene::ValueKind::Flag:
      return std::get<bool>(value);
    case scene::ValueKind::Whole:
      return std::get<std::int32_t>(value);
    case scene::ValueKind::Number: {
      Result<Json> list = numbers(std::array{std::get<float>(value)});
      return list ? Result<Json>((*list)[0]) : list;
    }
    case scene::ValueKind::Vector: {
      const glm::vec3 v = std::get<glm::vec3>(value);
      return numbers(std::array{v.x, v.y, v.z});
    }
    case scene::ValueKind::Rotation: {
      const glm::quat q = std::get<glm::quat>(value);
      return numbers(std::array{q.x, q.y, q.z, q.w});
    }
    case scene::ValueKind::Text:
      return std::get<std::string>(value);
    case scene::ValueKind::Word:
      return std::get<scene::Word>(value).text;
  }
  return Json{};
}

Place Place::at(const std::string& key) const {
  if (!value_->is_object()) fault("is not an object");
  const auto found = value_->find(key);
  const std::string way = way_.empty() ? key : way_ + "." + key;
  if (found == value_->end()) throw JsonFault{way, "is missing", ""};
  return {*found, way};
}

std::vector<std::pair<std::string, Place>> Place::members() const {
  if (!value_->is_object()) fault("is not an object");
  std::vector<std::pair<std::string, Place>> list;
  for (const auto& [key, value] : value_->items())
    list.emplace_back(key, Place(value, way_.empty() ? key : way_ + "." + key));
  return list;
}

std::vector<Place> Place::items() const {
  if (!value_->is_array()) fault("is not a list");
  std::vector<Place> list;
  for (std::size_t i = 0; i < value_->size(); ++i)
    list.emplace_back((*value_)[i], fmt::format("{}[{}]", way_, i));
  return list;
}

std::string Place::text() const {
  if (!value_->is_string()) fault("is not a text");
  return value_->get<std::string>();
}

bool Place::flag() const {
  if (!value_->is_boolean()) fault("is not true or false");
  return value_->get<bool>();
}

float Place::number() const {
  if (!value_->is_number()) fault("is not a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number) || std::abs(number) > double{std::numeric_limits<float>::max()})
    fault("is too large for a number");
  return static_cast<float>(number);
}

std::uint64_t Place::count(std::uint64_t largest) const {
  if (!value_->is_number_unsigned()) fault("is not a whole number from 0");
  const auto count = value_->get<std::uint64_t>();
  if (count > largest) fault(fmt::format("is {}, more than {}", count, largest));
  return count;
}

std::map<std::string, std::string> Place::table() const {
  std::map<std::string, std::string> table;
  for (const auto& [key, value] : members()) table[key] = value.text();
  return table;
}

scene::Value Place::value(const scene::FieldInfo& field) const {
  const auto numbers = [&](std::size_t count) {
    const std::vector<Place> parts = items();
    if (parts.size() != count) fault(fmt::format("is not a list of {} numbers", count));
    std::vector<float> list;
    for (const Place& part : parts) list.push_back(part.number());
    return list;
  };
  const scene::Value value = [&]() -> scene::Value {
    switch (field.kind) {
      case scene::ValueKind::Flag:
        return flag();
      case scene::ValueKind::Whole:
        if (!value_->is_number_integer() ||
            std::abs(value_->get<double>()) > double{std::numeric_limits<std::int32_t>::max()})
          fault("is not a whole number");
        return value_->get<std::int32_t>();
      case scene::ValueKind::Number:
        return number();
      case scene::ValueKind::Vector: {
        const auto list = numbers(3);
        return glm::vec3(list[0], list[1], list[2]);
      }
      case scene::ValueKind::Rotation: {
        const auto list = numbers(4);
        return glm::quat(list[3], list[0], list[1], list[2]);
      }
      case scene::ValueKind::Text:
        return text();
      case scene::ValueKind::Word:
        return scene::Word{text()};
    }
    return false;
  }();
  if (const Result<void> good = field.check(value); !good) fault(good.error().problem, good.error().hint);
  return value;
}

void Place::tellUnknown(const std::set<std::string>& known, std::vector<std::string>& notices) const {
  for (const auto& [key, place] : members())
    if (!known.contains(key))
      notices.push_back(place.way() + " is not known to this version; saving leaves it out");
}

namespace {

// Returns the deepest nesting of brackets outside of strings. (With a callback that counts, the parser would
// take quadratic time.)
int depthOf(std::string_view text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;  // skips the escaped character
    if (quoted) continue;
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
  }
  return deepest;
}

}  // namespace

Result<ReadJson> parseJson(std::string_view text, const std::string& subject) {
  // No valid file is as deep as this. Deeper ones could overflow the stack when they are written.
  constexpr int kMaxDepth = 64;
  if (depthOf(text) > kMaxDepth) return fail(subject, "is nested too deeply", "take an older copy");
  try {
    return ReadJson::parse(text);
  } catch (const nlohmann::json::exception& error) {
    std::string why = error.what();  // "[json.exception...] parse error at line 3, column 4: ..."
    if (const auto at = why.find("] "); at != std::string::npos) why.erase(0, at + 2);
    return fail(subject, "is not JSON: " + why, "mend it there, or take an older copy");
  }
}

}  // namespace lambent::editor
