// The name of an entity: an index that is used again after destruction and a generation that is not, so that
// a handle kept too long is recognised instead of meaning somebody else. Handles are valid in the registry
// that made them; what must outlive a session (world files, undo) refers to scene::StableId instead.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace lambent::ecs {

struct Entity {
  static constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t index = kNoIndex;
  std::uint32_t generation = 0;  // odd while the entity lives; 0 belongs to no entity

  // False for Entity{}, "none". A true handle may still be stale: ask Registry::alive.
  explicit operator bool() const { return index != kNoIndex; }
  auto operator<=>(const Entity&) const = default;
};

}  // namespace lambent::ecs
