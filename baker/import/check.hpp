// Mends and checks a glTF document before anything reads it by index: types, ranges, references, byte extents
// of every view and accessor, and the node tree. After this, code in this room may follow any index.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
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

// Returns the member of a member ..., or null.
const nlohmann::json& memberOf(const nlohmann::json& owner, std::initializer_list<const char*> keys);
// Returns the bytes of one component of an accessor, and how many a type such as "VEC3" has; 0 if it is
// unknown.
std::size_t componentBytes(std::uint64_t component_type);
std::size_t componentsOf(std::string_view type);

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

// Mends what is odd but harmless in a glTF document before it is checked, as common viewers read it: fields
// that only concern looks are clamped or left to their defaults, and what nothing reads is taken out. Each
// mend gives one warning that names the object. What is still wrong afterwards is refused by the checks.

// The largest number that a float holds.
inline constexpr double kAnyNumber = std::numeric_limits<float>::max();

// An Entry is one object of the document that may be changed, with the name that warnings use for it. Its
// functions do nothing if there is no such member.
struct Entry {
  nlohmann::json& json;
  std::string name;  // "light 3"
  std::vector<std::string>& warnings;

  nlohmann::json* find(const char* key) const {
    const auto found = json.is_object() ? json.find(key) : json.end();
    return found == json.end() ? nullptr : &*found;
  }
  void warn(const std::string& what) const { warnings.push_back(name + ": " + what); }
  void leaveOut(const char* key, const std::string& why) const;
  // Returns a member that is an object; another one is left out.
  std::optional<Entry> object(const char* key) const;
  std::optional<Entry> extension(const char* key) const;
  // Clamps a number, and leaves out what is no finite number.
  void clamp(const char* key, double least, double most) const;
  // Clamps a list of `count` numbers, and leaves out what is no such list.
  void clampAll(const char* key, std::size_t count, double least, double most) const;
  // Leaves out what is no whole number from 0 to `most`.
  void keepWhole(const char* key, std::uint64_t most) const;
};

// Calls mend(entry) for the objects of a list, which are named by `what` and their number.
template <typename Mend>
void forEachEntry(const Entry& owner, const char* key, const char* what, Mend mend) {
  nlohmann::json* list = owner.find(key);
  if (list == nullptr || !list->is_array()) return;
  for (std::size_t i = 0; i < list->size(); ++i)
    if ((*list)[i].is_object()) mend(Entry{(*list)[i], fmt::format("{} {}", what, i), owner.warnings});
}

// The whole document, in the order in which these are declared.
void mendCameras(const Entry& root);
void mendMembers(const Entry& root);  // null, whole numbers written as 24.0, -1 for no object
void mendMaterials(const Entry& root);
void mendLights(const Entry& root);
void mendPrimitives(const Entry& root);  // attributes of vertices, empty geometry
void mendAnimations(const Entry& root);
void mendUnused(const Entry& root);  // accessors and views that nothing reads

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
