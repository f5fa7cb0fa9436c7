// The media of a scene, as paths meet them; where several overlap their extinctions add. Comes in: the scene,
// all nodes at their place. Goes out: where a ray scatters next, by delta tracking (Woodcock et al. 1965),
// and what of light gets through, by residual ratio tracking (Novák, Selle and Jarosz, "Residual Ratio
// Tracking", SIGGRAPH Asia 2014); both without bias, for any density, through blocks with bounds of their
// own. Volumes without density are left out: with such ones a scene is as without any. Any thread.
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
  // Notices name volumes that are left out because their node is flat.
  static Volumes build(const Scene& scene, std::vector<std::string>& notices);

  bool empty() const { return grids_.empty(); }
  const std::vector<GridMedium>& grids() const { return grids_; }
  const SceneVolume& medium(std::uint32_t volume) const { return grids_[volume].volume(); }

  struct Collision {
    double t = 0.0;
    std::uint32_t volume = 0;
  };
  // The first one before `far`, in lengths of the ray's direction; Ray::far is not looked at.
  std::optional<Collision> collide(const Ray& ray, double far, Stream& random) const;
  // An estimate in 0..1 of exp(-optical depth); exactly 1 where nothing is met.
  double transmittance(const Ray& ray, double far, Stream& random) const;

 private:
  std::vector<GridMedium> grids_;
};

}  // namespace lambent::baker::reference
