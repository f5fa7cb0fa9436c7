// Thins out a group's light probes, so that its light is found at fewer places than it was baked for. It
// decides which light probes are kept, and from which of them each sample takes its light. Probes are kept in
// turn, each time the one farthest from all kept so far, so that even a few are spread over the whole group;
// each sample takes the nearest. No state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::lighting {

struct FewerSamples {
  std::vector<std::uint32_t> kept;   // indices of the group's samples, rising
  std::vector<std::uint32_t> place;  // per sample, an index into `kept`
};

// Keeps at most `most` samples, and at least one if there are any.
FewerSamples fewerSamples(std::span<const glm::vec3> samples, std::uint32_t most);

}  // namespace lambent::lighting
