// Gives checked access to JSON. Every look-up knows its path, so an error in a damaged file reads
// "groups[2].cells[0].sampleCount is missing". Faults are thrown as JsonFault; description_json.cpp turns
// them into an Error.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

namespace lambent::bundle {

using Json = nlohmann::json;

struct JsonFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Holds a value in the document and its path.
class Field {
 public:
  Field(const Json& value, std::string place) : value_(&value), place_(std::move(place)) {}

  [[noreturn]] void fault(const std::string& why) const { throw JsonFault(place_ + " " + why); }

  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  Field operator[](const char* key) const {
    if (!value_->is_object()) fault("is not an object");
    const auto found = value_->find(key);
    if (found == value_->end()) throw JsonFault(under(key) + " is missing");
    return {*found, under(key)};
  }
  std::vector<Field> items() const {
    if (!value_->is_array()) fault("is not a list");
    std::vector<Field> list;
    for (std::size_t i = 0; i < value_->size(); ++i)
      list.emplace_back((*value_)[i], fmt::format("{}[{}]", place_, i));
    return list;
  }
  // Returns the list under `key`, which is empty if the key is missing, since glTF omits empty lists.
  std::vector<Field> list(const char* key) const {
    return has(key) ? (*this)[key].items() : std::vector<Field>{};
  }

  std::string text() const {
    if (!value_->is_string()) fault("is not a text");
    return value_->get<std::string>();
  }
  bool flag() const {
    if (!value_->is_boolean()) fault("is not true or false");
    return value_->get<bool>();
  }
  float number() const { return static_cast<float>(preciseNumber()); }
  // Returns a number within the range of floats, without rounding it to one.
  double preciseNumber() const {
    if (!value_->is_number()) fault("is not a number");
    const double value = value_->get<double>();
    if (!std::isfinite(value) || std::abs(value) > double{std::numeric_limits<float>::max()})
      fault("is not finite");
    return value;
  }
  std::uint64_t count(std::uint64_t largest) const {
    if (!value_->is_number_unsigned()) fault("is not a whole number");
    const std::uint64_t value = value_->get<std::uint64_t>();
    if (value > largest) fault(fmt::format("is {}, more than {}", value, largest));
    return value;
  }
  // Returns an index into a list of `size` items.
  std::uint32_t index(std::size_t size) const {
    if (size == 0) fault("points into an empty list");
    return static_cast<std::uint32_t>(count(size - 1));
  }
  std::uint64_t hex64() const {
    const std::string digits = text();
    if (digits.size() != 16 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
      fault("is not 16 hexadecimal digits");
    return std::stoull(digits, nullptr, 16);
  }
  std::map<std::string, std::string> settings(const char* key) const {
    const Field table = (*this)[key];
    if (!table.value_->is_object()) table.fault("is not an object");
    std::map<std::string, std::string> out;
    for (const auto& [name, value] : table.value_->items())
      out[name] = Field(value, table.under(name.c_str())).text();
    return out;
  }
  template <typename Vec>
  Vec vector() const {
    const auto parts = items();
    Vec out{};
    if (parts.size() != static_cast<std::size_t>(Vec::length()))
      fault(fmt::format("is not {} numbers", Vec::length()));
    for (std::size_t i = 0; i < parts.size(); ++i)
      out[static_cast<int>(i)] = static_cast<typename Vec::value_type>(parts[i].preciseNumber());
    return out;
  }

 private:
  std::string under(const char* key) const { return place_.empty() ? key : place_ + "." + key; }

  const Json* value_;
  std::string place_;
};

template <typename Vec>
Json vectorJson(const Vec& v) {
  Json list = Json::array();
  for (int i = 0; i < Vec::length(); ++i) list.push_back(v[i]);
  return list;
}

inline Json hexJson(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

// gltf_json.cpp and transfer_json.cpp define these.
struct Description;
void writeGltf(const Description& description, std::uint64_t binary_bytes, Json& document);
void readGltf(const Field& document, std::uint64_t binary_bytes, Description& description);
Json writeTransfer(const Description& description);
void readTransfer(const Field& extension, Description& description);

}  // namespace lambent::bundle
