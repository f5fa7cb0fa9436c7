// The room baker/light_probes chooses the light probes of a group: points at which the runtime samples the
// light that comes in from outside, and the weights by which each sample of the group blends them (Sloan,
// Kautz and Snyder 2002, section 6.1). The group's samples, their areas and the planned count come in; points
// and weights per cell go out. A single point stands for light at infinity. Weights consider all points of
// the group, so light has no seam where cells meet. It works on several threads and has no errors.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/plan/local_light.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/transfer/weights.hpp"

namespace lambent::baker {

struct LightProbes {
  struct Cell {
    std::vector<std::uint32_t> points;  // rising; at most bundle::kMaxLightProbes
    std::vector<transfer::LightWeights>
        weights;  // one per sample of the cell; empty where there is one point
  };
  std::vector<glm::vec3> points;  // as SampleSet::positions; some cell uses each
  std::vector<Cell> cells;        // as SampleSet::cells
};

// `areas` comes from sampleAreas; the bounds are those of the group. Returns fewer than asked for if there
// are fewer distinct points, or if a cell would be lit from more than a bundle holds.
LightProbes chooseLightProbes(const SampleSet& samples, std::span<const float> areas, glm::vec3 bounds_min,
                              glm::vec3 bounds_max, LightProbeCount count);

}  // namespace lambent::baker
