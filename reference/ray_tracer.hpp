// Finds what rays meet, by Embree. This is the reference's own wrapper, so that it shares no ray code with
// the bake. Rays come in lists and travel 16 at a time. Cut-outs (alphaMode MASK) let rays through by their
// texture. Blended surfaces are kept apart, since only rays from the eye see them, as layers. Calls are safe
// from any thread; the Surfaces must outlive this.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "reference/surfaces.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

struct Ray {
  glm::vec3 origin{0.0f}, dir{0.0f};
  float far = 0.0f;  // in lengths of dir; rays begin at 0
};

class RayTracer {
 public:
  // Errors: Embree cannot be set up or runs out of memory.
  static Result<RayTracer> build(const Surfaces& surfaces);
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;
  ~RayTracer();

  // Finds the nearest hit of each ray, front or back.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
  // Sets blocked[i] to 1 if something lies on the ray, else to 0.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;
  // Finds what the eye sees along a ray, nearest first: blended layers, then the solid surface, if any. Backs
  // of single-sided surfaces are left out, because the runtime culls them.
  void visible(const Ray& ray, std::vector<Hit>& layers) const;

 private:
  struct State;
  explicit RayTracer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker::reference
