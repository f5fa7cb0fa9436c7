// Turns values of fields into JSON and back, for world files and the clipboard, and walks JSON with the way
// to each place, so that errors name it. Only this room uses it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor/document/world_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

using Json = nlohmann::ordered_json;  // to write: keys stay as they were put
using ReadJson =
    nlohmann::json;  // to read: looks keys up by a tree, so that large files take no square of time

// Writes the shortest decimal that reads back as the same float, so that 0.1 is written 0.1.
Json numberJson(float value);
// Writes rotations as [x, y, z, w], as glTF has them. Error: not finite.
Result<Json> valueJson(const scene::Value& value);

// A place in a document: a value and the way to it. Faults are thrown as JsonFault inside the room and become
// Errors at its border.
struct JsonFault {
  std::string place, problem, hint;
};

class Place {
 public:
  Place(const ReadJson& value, std::string way) : value_(&value), way_(std::move(way)) {}

  const ReadJson& json() const { return *value_; }
  const std::string& way() const { return way_; }
  [[noreturn]] void fault(std::string problem, std::string hint = {}) const {
    throw JsonFault{way_, std::move(problem), std::move(hint)};
  }
  bool has(const std::string& key) const { return value_->is_object() && value_->contains(key); }
  Place at(const std::string& key) const;                      // faults where it is missing
  std::vector<std::pair<std::string, Place>> members() const;  // of an object
  std::vector<Place> items() const;                            // of a list

  std::string text() const;
  bool flag() const;
  float number() const;
  std::uint64_t count(std::uint64_t largest) const;
  std::map<std::string, std::string> table() const;  // of texts
  std::vector<std::string> texts() const;
  // Returns the value as the field takes it: kind and range are checked.
  scene::Value value(const scene::FieldInfo& field) const;

  // Returns what is not among the known keys, as JSON texts; each is told in `notices`.
  UnknownFields unknown(const std::set<std::string>& known, std::vector<std::string>& notices) const;

 private:
  const ReadJson* value_;
  std::string way_;
};

// Parses a text. Errors name line and column.
Result<ReadJson> parseJson(std::string_view text, const std::string& subject);
void putUnknown(Json& object, const UnknownFields& unknown);

}  // namespace lambent::editor
