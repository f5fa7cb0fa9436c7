// Finds ray hits with Embree. The baker has its own wrapper, so that the two share no ray code. Rays are
// passed in lists and traced 16 at a time. Cut-outs (alphaMode MASK) are tested by their texture. Blended
// surfaces and panes are kept in a separate scene: eye rays see both as layers, and other rays pass panes.
// Calls are thread-safe; the Surfaces must outlive this.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "reference/surfaces.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

struct Ray {
  glm::vec3 origin{0.0f}, dir{0.0f};
  float far = 0.0f;  // in units of dir's length; rays begin at 0
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
  bool hasPanes() const;
  // Finds the faces of panes that a ray passes, nearest first.
  void panesOn(const Ray& ray, std::vector<Hit>& faces) const;
  // Finds what an eye ray sees, nearest first: layers of blended surfaces and panes, then the opaque surface,
  // if any. Backs of single-sided surfaces are skipped, because the runtime culls them.
  void visible(const Ray& ray, std::vector<Hit>& layers) const;

 private:
  struct State;
  explicit RayTracer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::baker::reference
