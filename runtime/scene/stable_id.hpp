// Names that outlive a session: undo, world files and scripts mean an entity by its StableId. It is made of
// the bundle's id, the instance number and the names on the way from the root (with a count where siblings
// share a name), so that a scene that is imported again, with nodes added or reordered elsewhere, keeps its
// ids. 64 bits by XXH3.
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

// The root entity of an instance.
StableId instanceId(std::string_view bundle_id, std::uint32_t instance);
// Of something below `parent`; ordinal counts earlier ones of the same parent, kind and name.
StableId childId(StableId parent, StableKind kind, std::string_view name, std::uint32_t ordinal);

}  // namespace lambent::scene
