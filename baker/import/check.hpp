// Mends (mend.hpp) and checks a glTF document before anything reads it by index. tinygltf trusts much of what
// a file says: it follows bufferView numbers, offsets and Draco attributes unchecked, cuts 64-bit numbers to
// int, and silently drops broken primitives. So a document passes here first: types, ranges, references, byte
// extents of every view and accessor, and the node tree. After this, code in this room may follow any index.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

// Returns whether this room reads the extension. Others cause a warning, and are refused if they are required
// and hold geometry.
bool readsExtension(std::string_view name);

// Errors name `file` and the object, such as "accessor 3". Warnings are those of mends.
Result<void> checkDocument(nlohmann::json& document, const std::string& file,
                           std::vector<std::string>& warnings);

// Gives the checks typed, ranged access to the fields of a glTF document. A wrong field throws BrokenField,
// which checkDocument() catches and turns into an Error; nothing else in the room throws.

struct BrokenField {
  std::string problem;
  std::string hint = "export the scene again, or look at it with a glTF validator";
};

// An Object is one object of the document, with the name that errors use for it.
struct Object {
  const nlohmann::json& json;
  std::string name;  // "accessor 3"

  const nlohmann::json* find(const char* key) const {
    if (!json.is_object()) throw BrokenField{fmt::format("{} is not an object", name)};
    const auto it = json.find(key);
    return it == json.end() ? nullptr : &*it;
  }

  std::optional<Object> object(const char* key) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return std::nullopt;
    if (!value->is_object()) throw BrokenField{fmt::format("{}: {} is not an object", name, key)};
    return Object{*value, fmt::format("{}: {}", name, key)};
  }

  // Returns a count, offset or index: an integer from 0 to 2^53.
  std::optional<std::uint64_t> number(const char* key) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return std::nullopt;
    return toNumber(*value, key);
  }

  std::uint64_t required(const char* key) const {
    const auto value = number(key);
    if (!value) throw BrokenField{fmt::format("{} has no {}", name, key)};
    return *value;
  }

  // Returns an index into the top-level list that holds `size` objects.
  std::optional<std::uint64_t> index(const char* key, std::size_t size, const char* list) const {
    const auto value = number(key);
    if (value && *value >= size)
      throw BrokenField{
          fmt::format("{}: {} {} does not exist (there are {} {})", name, key, *value, size, list)};
    return value;
  }

  std::string text(const char* key) const {
    const nlohmann::json* value = find(key);
    if (value == nullptr) return {};
    if (!value->is_string()) throw BrokenField{fmt::format("{}: {} is not a string", name, key)};
    return value->get<std::string>();
  }

  // Returns the elements of an array, empty if it is absent.
  const nlohmann::json& list(const char* key) const {
    static const nlohmann::json kEmpty = nlohmann::json::array();
    const nlohmann::json* value = find(key);
    if (value == nullptr) return kEmpty;
    if (!value->is_array()) throw BrokenField{fmt::format("{}: {} is not an array", name, key)};
    return *value;
  }

  std::uint64_t toNumber(const nlohmann::json& value, const std::string& key) const {
    constexpr std::uint64_t kLargest = std::uint64_t{1} << 53;
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kLargest)
      throw BrokenField{fmt::format("{}: {} is not a whole number from 0 up", name, key)};
    return value.get<std::uint64_t>();
  }
};

// Root is the top level of the document, with the number of objects in each list.
struct Root {
  Object object;

  std::size_t size(const char* key) const { return object.list(key).size(); }
  template <typename Check>
  void forEach(const char* key, const char* name, Check check) const {
    std::size_t i = 0;
    for (const nlohmann::json& item : object.list(key)) {
      const Object entry{item, fmt::format("{} {}", name, i++)};
      if (!item.is_object()) throw BrokenField{fmt::format("{} is not an object", entry.name)};
      check(entry);
    }
  }
};

// Requires finite numbers: `count` of them, or any number of them if it is 0.
void checkNumbers(const Object& object, const char* key, std::size_t count = 0);

// Checks that the textures of a material exist, and the file that `extras.lambent.brdf` names. Mends have
// been to all else in it.
void checkMaterial(const Object& material, const Root& root);
void checkNodeExtensions(const Object& node, const Root& root);  // lights, instances

void checkNodeGrids(const Object& node);  // volumes, neighborhoods

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
void checkMeshopt(const Object& view, const Root& root);  // a bufferView, if meshoptimizer coded it
void checkBuffers(const Root& root);                      // every byte extent of buffers, views and accessors
void checkView(const Object& view, const Root& root);
void checkAccessor(const Object& accessor, const Root& root);
void checkNodes(const Root& root);  // nodes, scenes, animations: a forest, all references

}  // namespace lambent::baker
