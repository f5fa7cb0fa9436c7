// A VertexKey identifies a surface point by the bits of its position and normal and by what is stored there;
// points with the same key have the same transfer.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

using VertexKey = std::array<std::uint32_t, 8>;  // the last is for callers

struct VertexKeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const std::uint32_t word : key) hash = (hash ^ word) * 0xD6E8FEB86659FD93u, hash ^= hash >> 32;
    return hash;
  }
};

inline VertexKey vertexKey(const glm::vec3& position, const glm::vec3& normal, SampleKind kind) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return {bits(position.x),
          bits(position.y),
          bits(position.z),
          bits(normal.x),
          bits(normal.y),
          bits(normal.z),
          static_cast<std::uint32_t>(kind),
          0};
}

}  // namespace lambent::baker
