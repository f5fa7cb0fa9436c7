// What arrives at places of a medium without having been scattered.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/sphere_table.hpp"

namespace lambent::baker {

// Share of the directions whose light the medium meets, and of those from which it comes through, or from a
// surface.
struct Arrival {
  double met = 0.0, out = 0.0;
};

// One per thread. All that is passed outlives it.
class FirstLight {
 public:
  FirstLight(const DensityField& density, const Occluders& occluders)
      : density_(density), occluders_(occluders) {}

  // transfer: mean radiance by coefficient of the light, as many as the table has.
  Arrival look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer);

 private:
  const DensityField& density_;
  const Occluders& occluders_;
  std::vector<float> reach_;
  std::vector<double> lost_;
};

}  // namespace lambent::baker
