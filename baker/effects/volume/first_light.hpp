// Holds directions spread evenly over the whole sphere (spherical Fibonacci lattice), all of the same weight,
// with their spherical harmonics.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/effects/volume/grids.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

inline constexpr double kMeanOfBandZero = 0.28209479177387814;  // y_00

class SphereTable {
 public:
  // rays > 0; order 1..sh::kMaxBasisOrder. `turn` rotates the directions, so that neighbouring tables differ.
  SphereTable(std::size_t rays, int order, const glm::dquat& turn = glm::dquat(1.0, 0.0, 0.0, 0.0));

  std::size_t size() const { return directions_.size(); }
  const glm::vec3& direction(std::size_t ray) const { return directions_[ray]; }
  std::span<const glm::vec3> directions() const { return directions_; }
  // Returns y_i in the direction of a ray, unweighted; order² values.
  std::span<const float> harmonics(std::size_t ray) const {
    return std::span(harmonics_).subspan(ray * columns_, columns_);
  }
  // Returns the mean of y_i over all directions, which is nearly 0 except for y_0.
  double mean(std::size_t i) const { return means_[i]; }

 private:
  std::size_t columns_;
  std::vector<glm::vec3> directions_;
  std::vector<float> harmonics_;
  std::vector<double> means_;
};

// Holds the surfaces that a volume never moves against, for its rays to hit.

class Occluders {
 public:
  Occluders() = default;  // none
  // `scene_from_group` maps the volume's frame to that of the rays' scene; it is a rotation and a
  // translation.
  Occluders(const RayScene& rays, const glm::mat4& scene_from_group)
      : rays_(&rays), scene_from_group_(scene_from_group) {}

  bool any() const { return rays_ != nullptr; }

  // Computes how far each ray from `origin` gets, in metres; infinity if it hits nothing.
  void reach(const glm::vec3& origin, std::span<const glm::vec3> directions,
             std::span<float> distances) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    if (rays_ == nullptr) {
      std::fill(distances.begin(), distances.end(), kFar);
      return;
    }
    const glm::vec3 from(scene_from_group_ * glm::vec4(origin, 1.0f));
    std::vector<RaySegment> segments(directions.size());
    for (std::size_t i = 0; i < segments.size(); ++i)
      segments[i] = {from, glm::vec3(scene_from_group_ * glm::vec4(directions[i], 0.0f)), kFar};
    std::vector<FirstHit> hits(segments.size());
    rays_->firstHits(segments, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) distances[i] = hits[i].distance;
  }

 private:
  const RayScene* rays_ = nullptr;
  glm::mat4 scene_from_group_{1.0f};
};

// Computes the light that arrives at places of a medium without having been scattered.

// Shares of the directions from a place: `met` is the part of a ray that the medium takes before the ray
// ends, `out` the part that reaches the outside or a surface. Both are means over the rays, and their sum is
// 1.
struct Arrival {
  double met = 0.0, out = 0.0;
};

// One object serves one thread. Both arguments must outlive it.
class FirstLight {
 public:
  FirstLight(const DensityField& density, const Occluders& occluders)
      : density_(density), occluders_(occluders) {}

  // Traces the table's rays from `place`. `transfer` receives the mean radiance per coefficient of the light.
  Arrival look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer);

 private:
  const DensityField& density_;
  const Occluders& occluders_;
  std::vector<float> reach_;
  std::vector<double> lost_;
};

}  // namespace lambent::baker
