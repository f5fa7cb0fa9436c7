// Mends and checks a glTF document before anything reads it by index: types, ranges, references, byte extents
// of every view and accessor. After this, code in this room may follow any index.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/scene_files.hpp"

namespace lambent::baker {

// Returns whether this room reads the extension. Others cause a warning, and are refused if they are required
// and hold geometry.
bool readsExtension(std::string_view name);

// Mends first, so that files are read as common viewers read them: fields that only concern looks are clamped
// or left to their defaults, and what nothing reads is taken out. Each mend gives one warning that names the
// object. What is still wrong then is thrown, as an Error that names the object, such as "accessor 3".
void checkDocument(nlohmann::json& document, std::vector<std::string>& warnings);

// Returns the member of a member ..., or null.
const nlohmann::json& memberOf(const nlohmann::json& owner, std::initializer_list<const char*> keys);
bool isFiniteNumber(const nlohmann::json& value);
// Returns the bytes of one component of an accessor, and how many a type such as "VEC3" has; 0 if it is
// unknown.
std::size_t componentBytes(std::uint64_t component_type);
std::size_t componentsOf(std::string_view type);

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";

// The largest number that a float holds.
inline constexpr double kAnyNumber = std::numeric_limits<float>::max();

struct CheckedDocument {
  nlohmann::json& json;
  std::vector<std::string>& warnings;
  std::map<std::string, std::set<std::size_t>> used = {};  // by list, the objects that others refer to
};

// An Entry is one object of the document, with the name that warnings and errors use for it. Its functions do
// nothing if there is no such member.
struct Entry {
  nlohmann::json& json;
  std::string name;  // "light 3"
  CheckedDocument& document;

  nlohmann::json* find(const char* key) const;
  void warn(const std::string& what) const { document.warnings.push_back(name + ": " + what); }
  void leaveOut(const char* key, const std::string& why) const;
  // Returns a member that is an object; another one is left out.
  std::optional<Entry> object(const char* key) const;
  std::optional<Entry> extension(const char* key) const;
  // Returns what stands under our own name in `extras`, which may hold anything else.
  std::optional<Entry> ours() const;
  // Clamps a number, and leaves out what is no finite number.
  void clamp(const char* key, double least, double most) const;
  // Clamps a list of `count` numbers, and leaves out what is no such list.
  void clampAll(const char* key, std::size_t count, double least, double most) const;
  // Leaves out what is no whole number from 0 to `most`.
  void keepWhole(const char* key, std::uint64_t most) const;

  // The functions below refuse members of a wrong type.

  // Returns the elements of an array, empty if it is absent.
  const nlohmann::json& list(const char* key) const;
  // Calls visit(entry) for the objects of a list, which are named by `what` and their number.
  template <typename Visit>
  void forEach(const char* key, const std::string& what, Visit visit) const {
    for (std::size_t i = 0; i < list(key).size(); ++i) {
      nlohmann::json& item = json[key][i];
      if (!item.is_object()) refuse("{} {} is not an object", what, i);
      visit(Entry{item, fmt::format("{} {}", what, i), document});
    }
  }
  // Returns a count, offset or index: an integer from 0 to 2^53.
  std::optional<std::uint64_t> number(const char* key) const;
  std::uint64_t required(const char* key) const;
  std::uint64_t toNumber(const nlohmann::json& value, const std::string& key) const;
  // Returns a number below `size`, that of the objects of a list.
  std::optional<std::uint64_t> below(const char* key, std::size_t size, const char* list) const;
  // Returns an index into a list of the document, whose object then counts as used.
  std::optional<std::uint64_t> index(const char* key, const char* list) const;
  // Does so for the members of this object.
  void indexAll(const char* list) const;
  std::string text(const char* key) const;
  // Requires finite numbers: `count` of them, or any number of them if it is 0.
  void numbers(const char* key, std::size_t count = 0) const;
};

// The mends of the whole document, in the order in which these are declared.
void mendCameras(const Entry& root);
void mendMembers(const Entry& root);  // null, whole numbers written as 24.0, -1 for no object
void mendMaterials(const Entry& root);
void mendLights(const Entry& root);
void mendPrimitives(const Entry& root);  // attributes of vertices, empty geometry
void mendAnimations(const Entry& root);

}  // namespace lambent::baker
