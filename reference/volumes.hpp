// Volumes are the media of a scene, as paths meet them; where several overlap, their extinctions add. The
// scene comes in, with all nodes in place. It answers where a ray scatters next, by delta tracking (Woodcock
// et al. 1965), and how much light gets through, by residual ratio tracking (Novák, Selle and Jarosz,
// "Residual Ratio Tracking", SIGGRAPH Asia 2014). Both are unbiased for any density and use blocks with
// bounds of their own. Volumes without density are left out, so that a scene with them gives the same picture
// as one without. Calls are safe from any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "reference/grid_medium.hpp"
#include "reference/sampler.hpp"

namespace lambent::baker::reference {

class Volumes {
 public:
  // `notices` receives the names of volumes that are left out because their node is flat.
  static Volumes build(const Scene& scene, std::vector<std::string>& notices);

  bool empty() const { return grids_.empty(); }
  const std::vector<GridMedium>& grids() const { return grids_; }
  const SceneVolume& medium(std::uint32_t volume) const { return grids_[volume].volume(); }

  struct Collision {
    double t = 0.0;
    std::uint32_t volume = 0;
  };
  // Returns the first collision before `far`, in lengths of the ray's direction; Ray::far is ignored.
  std::optional<Collision> collide(const Ray& ray, double far, Stream& random) const;
  // Returns an unbiased estimate in 0..1 of exp(-optical depth); exactly 1 if nothing is met.
  double transmittance(const Ray& ray, double far, Stream& random) const;

 private:
  std::vector<GridMedium> grids_;
};

}  // namespace lambent::baker::reference
