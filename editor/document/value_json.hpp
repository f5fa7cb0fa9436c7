// Converts field values to JSON and back, for world files and scripts. Its reader knows the path to each JSON
// value, so that errors can name it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor/document/document.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

using Json = nlohmann::ordered_json;  // for writing: keys keep their order
using ReadJson = nlohmann::json;      // for reading: finds a key in logarithmic time, which large files need

// Writes the shortest decimal number that reads back as the same float.
Json numberJson(float value);
// Writes a value; rotations become [x, y, z, w], as in glTF. Error: a number is not finite.
Result<Json> valueJson(const scene::Value& value);

// A JsonFault is wrong input. It is thrown inside this room only; public functions turn it into an Error.
struct JsonFault {
  std::string place, problem, hint;
};

// A Place is a JSON value with its path in the document.
class Place {
 public:
  Place(const ReadJson& value, std::string way) : value_(&value), way_(std::move(way)) {}

  const ReadJson& json() const { return *value_; }
  const std::string& way() const { return way_; }
  [[noreturn]] void fault(std::string problem, std::string hint = {}) const {
    throw JsonFault{way_, std::move(problem), std::move(hint)};
  }
  bool has(const std::string& key) const { return value_->is_object() && value_->contains(key); }
  Place at(const std::string& key) const;                      // faults if the key is missing
  std::vector<std::pair<std::string, Place>> members() const;  // faults if this is no object
  std::vector<Place> items() const;                            // faults if this is no list

  std::string text() const;
  bool flag() const;
  float number() const;
  std::uint64_t count(std::uint64_t largest) const;
  std::map<std::string, std::string> table() const;  // an object whose values are strings
  // Returns the value of a field. Faults if its kind or range is wrong.
  scene::Value value(const scene::FieldInfo& field) const;

  // Adds a notice for each member whose key is not known.
  void tellUnknown(const std::set<std::string>& known, std::vector<std::string>& notices) const;

 private:
  const ReadJson* value_;
  std::string way_;
};

// Parses a text. An error names the line and column.
Result<ReadJson> parseJson(std::string_view text, const std::string& subject);

}  // namespace lambent::editor
