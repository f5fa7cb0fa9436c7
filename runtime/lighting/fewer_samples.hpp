// A group's light at fewer places than it was baked for: which of its light probes are kept, and for each
// sample the kept one that it takes its light from. Kept are, one after the other, those farthest from all
// that are kept already, so that few of them stand all over the group; each sample takes the nearest. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::lighting {

struct FewerSamples {
  std::vector<std::uint32_t> kept;   // of the group's samples, rising
  std::vector<std::uint32_t> place;  // per sample: among the kept
};

// At most `most` are kept, at least one where there are any.
FewerSamples fewerSamples(std::span<const glm::vec3> samples, std::uint32_t most);

}  // namespace lambent::lighting
