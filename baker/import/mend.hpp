// Mends what is odd but harmless in a glTF document before it is checked, as common viewers read it: fields
// that only concern looks are clamped or left to their defaults, and what nothing reads is taken out. Each
// mend gives one warning that names the object. What is still wrong afterwards is refused by the checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lambent::baker {

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

}  // namespace lambent::baker
