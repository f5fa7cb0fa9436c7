// Everything that light and rays meet.
#pragma once

#include <vector>

#include "baker/reference/camera.hpp"
#include "baker/reference/environment.hpp"
#include "baker/reference/lamps.hpp"
#include "baker/reference/ray_tracer.hpp"
#include "baker/reference/shape_lights.hpp"
#include "baker/reference/volumes.hpp"

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
