// Holds directions spread evenly over the whole sphere (spherical Fibonacci lattice), all of the same weight,
// with their spherical harmonics.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

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

}  // namespace lambent::baker
