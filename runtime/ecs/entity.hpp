// An Entity is a handle: an index, which is reused after destruction, and a generation, which is not. So a
// stale handle is detected instead of meaning another entity. Handles are valid in the registry that made
// them. Data that outlives a session (world files, undo) uses scene::StableId instead.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace lambent::ecs {

struct Entity {
  static constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t index = kNoIndex;
  std::uint32_t generation = 0;  // odd while the entity lives; 0 belongs to no entity

  // Returns false for Entity{}, which means "none". If it returns true, the handle may still be stale, which
  // Registry::alive tells.
  explicit operator bool() const { return index != kNoIndex; }
  auto operator<=>(const Entity&) const = default;
};

}  // namespace lambent::ecs
