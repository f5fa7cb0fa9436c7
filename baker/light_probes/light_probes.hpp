// The light probes of a group: points around which the runtime samples the light that comes in from outside,
// and from which of them each sample of the group is lit (Sloan, Kautz and Snyder 2002, section 6.1). One
// point stands for light at infinity. Weights look at all points of the group, so light has no seam where
// cells meet.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/plan/local_light.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/light_weights.hpp"

namespace lambent::baker {

struct LightProbes {
  struct Cell {
    std::vector<std::uint32_t> points;          // rising; at most bundle::kMaxLightProbes
    std::vector<bundle::LightWeights> weights;  // one per sample of the cell; empty where there is one point
  };
  std::vector<glm::vec3> points;  // as SampleSet::positions; each is used by some cell
  std::vector<Cell> cells;        // as SampleSet::cells
};

// `areas` as sampleAreas gives them; the bounds are the group's. There may come fewer than asked for: where
// there are fewer distinct points, and where a cell would be lit from more than a bundle holds.
LightProbes chooseLightProbes(const SampleSet& samples, std::span<const float> areas, glm::vec3 bounds_min,
                              glm::vec3 bounds_max, LightProbeCount count);

}  // namespace lambent::baker
