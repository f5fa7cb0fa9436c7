// What rays meet, by Embree: the reference's own wrapper, so that it shares no ray code with the bake. Rays
// come in lists and travel 16 at a time. Cut-outs (alphaMode MASK) let rays through by their texture. Blended
// surfaces stand apart: only rays from the eye see them, as layers. Any thread; the Surfaces must outlive it.
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
  static Result<RayTracer> build(const Surfaces& surfaces);
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;
  ~RayTracer();

  // The nearest hit of each ray, front or back.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
  // blocked[i] = 1 where something lies on the ray.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const;
  // What the eye sees along a ray, nearest first: blended layers, then the solid surface, if any. The backs
  // of one-sided surfaces are left out, as the runtime culls them.
  void visible(const Ray& ray, std::vector<Hit>& layers) const;

 private:
  struct State;
  explicit RayTracer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker::reference
