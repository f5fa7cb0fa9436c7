// Converts a Description to and from the JSON chunk of a bundle, a glTF 2.0 document with the extension
// LAMBENT_radiance_transfer. gltf_json.cpp and gltf_parts_json.cpp have the glTF part, transfer_json.cpp has
// the extension. Only this room and its tests include this header.
//
// Every look-up in the JSON knows its path, so an error in a damaged file reads
// "groups[2].cells[0].sampleCount is missing". Faults are thrown as JsonFault; fromJson() turns them into an
// Error. The fields of a struct stand in one list, a function that names key and member of each: called with
// a FieldIo it reads and checks them, or writes them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::bundle {

using Json = nlohmann::json;

// The last bufferView of the file is not one of Description::views. It is 16 bytes at the start of the binary
// chunk: the checksum of the JSON chunk and its complement. With it no byte of the file can change unnoticed.
inline constexpr std::uint64_t kIntegrityBytes = 16;

// Returns the JSON text. Views must lie inside `binary_bytes`.
std::string toJson(const Description& description, std::uint64_t binary_bytes);

// Fails, naming `file`, if the text is not JSON or has no extension (so it is not a bundle), if this program
// does not know the version, or if anything is missing, of the wrong type or out of range. Keyframes of
// animations get their sizes only; their values are in the binary chunk.
Result<Description> fromJson(const std::string& text, std::uint64_t binary_bytes, const std::string& file);

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
  // Returns the value whose index in the list the word has.
  template <class Enum, std::size_t N>
  Enum word(const std::array<const char*, N>& words) const {
    const std::string word = text();
    const auto found = std::find(words.begin(), words.end(), word);
    if (found == words.end()) fault("is \"" + word + "\", which this program does not know");
    return static_cast<Enum>(found - words.begin());
  }
  std::uint64_t hex64() const {
    const std::string digits = text();
    if (digits.size() != 16 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
      fault("is not 16 hexadecimal digits");
    return std::stoull(digits, nullptr, 16);
  }
  std::map<std::string, std::string> settings() const {
    if (!value_->is_object()) fault("is not an object");
    std::map<std::string, std::string> out;
    for (const auto& [name, value] : value_->items()) out[name] = Field(value, under(name.c_str())).text();
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

// Values of each type as JSON, in both directions.
template <class T>
Json valueJson(const T& value) {
  return value;
}
template <glm::length_t N, class T>
Json valueJson(const glm::vec<N, T>& value) {
  return vectorJson(value);
}
inline Json valueJson(const std::vector<glm::vec3>& values) {
  Json list = Json::array();
  for (const glm::vec3& value : values) list.push_back(vectorJson(value));
  return list;
}
template <class T>
Json valueJson(const glm::mat<4, 4, T>& value) {
  Json list = Json::array();
  for (int i = 0; i < 16; ++i) list.push_back(glm::value_ptr(value)[i]);
  return list;
}
inline void readValue(const Field& field, std::string& value) {
  value = field.text();
}
inline void readValue(const Field& field, float& value) {
  value = field.number();
}
inline void readValue(const Field& field, bool& value) {
  value = field.flag();
}
template <glm::length_t N, class T>
void readValue(const Field& field, glm::vec<N, T>& value) {
  value = field.vector<glm::vec<N, T>>();
}
inline void readValue(const Field& field, std::vector<glm::vec3>& values) {
  values.clear();
  for (const Field& entry : field.items()) values.push_back(entry.vector<glm::vec3>());
}
template <class T>
void readValue(const Field& field, glm::mat<4, 4, T>& value) {
  const auto entries = field.items();
  if (entries.size() != 16) field.fault("is not 16 numbers");
  for (std::size_t i = 0; i < 16; ++i) glm::value_ptr(value)[i] = static_cast<T>(entries[i].preciseNumber());
}
inline void readValue(const Field& field, std::map<std::string, std::string>& values) {
  values = field.settings();
}

// Reads members from the fields of an object and checks them, or writes them as fields of an object.
template <bool Reads>
class FieldIo {
 public:
  static constexpr bool kReads = Reads;
  FieldIo(std::conditional_t<Reads, Field, Json&> object, const Description& description)
      : object_(object), description_(description) {
    if constexpr (!Reads) object_ = Json::object();
  }

  const Field& field() const { return object_; }
  // Returns whether an optional field is there; it is written if `said`.
  bool has(const char* key, bool said) const {
    if constexpr (Reads) return object_.has(key);
    return said;
  }
  void require(bool holds, const char* key, const std::string& why) const {
    if constexpr (Reads)
      if (!holds) object_[key].fault(why);
  }

  template <class T>
  void operator()(const char* key, T& value) const {
    if constexpr (Reads)
      readValue(object_[key], value);
    else
      object_[key] = valueJson(value);
  }
  void name(auto& text) const {
    if (has("name", !text.empty())) (*this)("name", text);
  }
  void notNegative(const char* key, auto& value) const {
    (*this)(key, value);
    require(value >= 0.0f, key, "is negative");
  }
  template <class T>
  void count(const char* key, T& value, std::uint64_t most) const {
    if constexpr (Reads)
      value = static_cast<T>(object_[key].count(most));
    else
      object_[key] = value;
  }
  // Reads an index into a list of `size` items.
  template <class T>
  void index(const char* key, T& value, std::size_t size) const {
    if constexpr (Reads)
      value = static_cast<T>(object_[key].index(size));
    else
      object_[key] = value;
  }
  // -1 is not written.
  void optionalIndex(const char* key, auto& value, std::size_t size) const {
    if (has(key, value >= 0)) index(key, value, size);
  }
  // Reads the index of a payload of this type and, if given, this length.
  void payload(const char* key, auto& value, PayloadType type,
               std::optional<std::uint64_t> raw_length = {}) const {
    index(key, value, description_.payloads.size());
    if constexpr (Reads) {
      const Payload& payload = description_.payloads[static_cast<std::size_t>(value)];
      require(payload.type == type, key, "is a payload of another type");
      require(!raw_length || payload.raw_length == *raw_length, key, "is a payload of another size");
    }
  }
  template <class Enum, std::size_t N>
  void word(const char* key, Enum& value, const std::array<const char*, N>& words) const {
    if constexpr (Reads)
      value = object_[key].template word<Enum>(words);
    else
      object_[key] = words[static_cast<std::size_t>(value)];
  }
  template <class Items, class Each>
  void list(const char* key, Items& items, Each each) const {
    if constexpr (Reads) {
      for (const Field& entry : object_[key].items()) {
        typename Items::value_type item;
        each(FieldIo(entry, description_), item);
        items.push_back(std::move(item));
      }
    } else {
      Json& list = object_[key] = Json::array();
      for (const auto& item : items) each(FieldIo(list.emplace_back(), description_), item);
    }
  }
  template <class Each>
  void child(const char* key, Each each) const {
    each(FieldIo(object_[key], description_));
  }
  template <class T, class Each>
  void optional(const char* key, T& value, Each each) const {
    if (!has(key, value.has_value())) return;
    if constexpr (Reads) value.emplace();
    child(key, [&](const auto& fields) { each(fields, *value); });
  }

 private:
  std::conditional_t<Reads, Field, Json&> object_;
  const Description& description_;
};
using FieldReader = FieldIo<true>;

// Returns the object that a list of fields writes.
template <class Fields>
Json written(const Description& description, Fields fields) {
  Json json;
  fields(FieldIo<false>(json, description));
  return json;
}

Json writeTransfer(const Description& description);
void readTransfer(const Field& extension, Description& description);

// Adds the extensions that the material needs to `used`.
Json materialJson(const gltf::Material& material, std::set<std::string>& used);
gltf::Material readMaterial(const Field& field, std::size_t texture_count);

// Returns the keyframes of an animation, which form one view: for each channel its times, then its values,
// all float32. The views of the animations are the last of Description::views, in order.
Blob animationBytes(const gltf::Animation& animation);
Json animationJson(const gltf::Animation& animation, std::size_t view, Json& accessors);
// Gives times and values their sizes, which must fill the view; loadAnimation() fills in the numbers.
gltf::Animation readAnimation(const Field& field, const std::vector<Field>& accessors, std::size_t view,
                              std::uint64_t view_bytes, const std::vector<gltf::Node>& nodes);
// Fills in the keyframes from the bytes of the view, whose length must match the sizes. Returns false if
// times do not rise or a number is not finite.
bool loadAnimation(gltf::Animation& animation, std::span<const std::byte> bytes);

}  // namespace lambent::bundle
