// A StableId identifies an entity across sessions, in undo, world files and scripts. It is a 64-bit XXH3 hash
// of the bundle's id, the instance number and the names on the path from the root (with a count if siblings
// share a name). So a scene keeps its ids when it is imported again with nodes added or reordered elsewhere.
#pragma once

#include <compare>
#include <cstdint>
#include <string_view>

namespace lambent::scene {

struct StableId {
  std::uint64_t value = 0;
  auto operator<=>(const StableId&) const = default;
};

enum class StableKind : std::uint8_t { Node = 1, Group, Draw, Lamp, Animation, Material };

// Returns the id of an instance's root entity.
StableId instanceId(std::string_view bundle_id, std::uint32_t instance);
// Returns the id of an entity below `parent`. `ordinal` is the number of earlier ones with the same parent,
// kind and name.
StableId childId(StableId parent, StableKind kind, std::string_view name, std::uint32_t ordinal);

}  // namespace lambent::scene
