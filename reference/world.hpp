// Bundles references to everything that paths of one picture need.
#pragma once

#include <vector>

#include "reference/camera.hpp"
#include "reference/environment.hpp"
#include "reference/lamps.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/shape_lights.hpp"
#include "reference/volumes.hpp"

namespace lambent::baker::reference {

struct World {
  const Surfaces& surfaces;
  const RayTracer& rays;
  const Environment& environment;
  const EmissiveTriangles& emissive;
  const std::vector<PunctualLight>& punctual;
  const std::vector<spec::LocalLight>& shapes;
  const Volumes& volumes;
  EyeRays eye;
};

}  // namespace lambent::baker::reference
