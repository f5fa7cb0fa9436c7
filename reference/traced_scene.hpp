// A scene as paths meet it, whatever light from infinity and view there are: surfaces, the hierarchy over
// them, what in the file shines, volumes. Comes in: import's Scene, all nodes at their place. Slow to build,
// free to share: any number of pictures may be traced of one at a time, from any thread. The Scene must
// outlive it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reference/world.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

class TracedScene {
 public:
  // Errors: a texture that cannot be decoded; Embree without memory.
  static Result<std::unique_ptr<const TracedScene>> build(const Scene& scene);

  const Surfaces& surfaces() const { return surfaces_; }
  const Volumes& volumes() const { return volumes_; }
  // What was put aside, a sentence each.
  const std::vector<std::string>& notices() const { return notices_; }

  // Everything must outlive the world.
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
