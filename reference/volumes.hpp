// Holds the participating media of a scene; where several overlap, their extinctions add. The scene comes in,
// with all nodes in place. It samples collisions by delta tracking (Woodcock et al. 1965) and estimates
// transmittance by residual ratio tracking (Novák, Selle and Jarosz, "Residual Ratio Tracking", SIGGRAPH Asia
// 2014). Both are unbiased for any density and use density bounds per block. Volumes without density are
// skipped, so that they do not change a picture. Calls are thread-safe.
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
  // Adds a notice for each volume that is skipped because its node is flat.
  static Volumes build(const Scene& scene, std::vector<std::string>& notices);

  bool empty() const { return grids_.empty(); }
  const std::vector<GridMedium>& grids() const { return grids_; }
  const SceneVolume& medium(std::uint32_t volume) const { return grids_[volume].volume(); }

  struct Collision {
    double t = 0.0;
    std::uint32_t volume = 0;
  };
  // Samples the first collision before `far`, in units of the ray direction's length. Ray::far is ignored.
  std::optional<Collision> collide(const Ray& ray, double far, Stream& random) const;
  // Returns an unbiased estimate of exp(-optical depth), in 0..1; exactly 1 if the ray meets no medium.
  double transmittance(const Ray& ray, double far, Stream& random) const;

 private:
  std::vector<GridMedium> grids_;
};

}  // namespace lambent::baker::reference
