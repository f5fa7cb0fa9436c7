// Computes the light that arrives at places of a medium without having been scattered.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/volume/density_field.hpp"
#include "baker/effects/volume/occluders.hpp"
#include "baker/effects/volume/sphere_table.hpp"

namespace lambent::baker {

// Shares of the directions from a place: `met` is the part of a ray that the medium takes before the ray
// ends, `out` the part that reaches the outside or a surface. Both are means over the rays, and their sum is
// 1.
struct Arrival {
  double met = 0.0, out = 0.0;
};

// One object serves one thread. Both arguments must outlive it.
class FirstLight {
 public:
  FirstLight(const DensityField& density, const Occluders& occluders)
      : density_(density), occluders_(occluders) {}

  // Traces the table's rays from `place`. `transfer` receives the mean radiance per coefficient of the light.
  Arrival look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer);

 private:
  const DensityField& density_;
  const Occluders& occluders_;
  std::vector<float> reach_;
  std::vector<double> lost_;
};

}  // namespace lambent::baker
