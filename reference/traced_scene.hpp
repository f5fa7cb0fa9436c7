// A TracedScene is a scene prepared for path tracing, independent of distant light and view: surfaces, their
// ray-tracing hierarchy, the lights of the file, and volumes. The importer's Scene comes in, with all nodes
// in place. It is slow to build, but any number of threads may trace pictures of it at the same time. The
// Scene must outlive it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reference/camera.hpp"
#include "reference/environment.hpp"
#include "reference/lamps.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/volumes.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

// Bundles references to everything that paths of one picture need.
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

class TracedScene {
 public:
  // Errors: a texture cannot be decoded, or Embree has no memory.
  static Result<std::unique_ptr<const TracedScene>> build(const Scene& scene);

  const Surfaces& surfaces() const { return surfaces_; }
  const Volumes& volumes() const { return volumes_; }
  // Returns what was left out, one sentence each.
  const std::vector<std::string>& notices() const { return notices_; }

  // Combines the scene with a light and a view. This object and all arguments must outlive the result.
  World under(const Environment& environment, const std::vector<spec::LocalLight>& shapes,
              const EyeRays& eye) const;

 private:
  TracedScene(const Scene& scene, Surfaces surfaces);

  Surfaces surfaces_;
  EmissiveTriangles emissive_;
  std::vector<PunctualLight> punctual_;
  std::vector<std::string> notices_;
  Volumes volumes_;
  Result<RayTracer> rays_;
};

}  // namespace lambent::baker::reference
