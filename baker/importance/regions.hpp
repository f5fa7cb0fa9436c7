// Divides what eyes see into regions that take up about as much of all pictures, so that errors are bounded
// in each part of what is seen and not only on average.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::baker {

class Regions {
 public:
  Regions() = default;
  // Points that count alike are divided in halves along the longest axis, `depth` times.
  Regions(std::vector<glm::vec3> points, int depth);

  std::size_t size() const { return std::size_t{1} << depth_; }
  std::size_t at(const glm::vec3& position) const;

 private:
  struct Cut {
    int axis = 0;
    float at = 0.0f;
  };
  std::vector<Cut> cuts_;  // a complete binary tree; the children of cut i are 2 i + 1 and 2 i + 2
  int depth_ = 0;
};

// Returns the 95th percentile of errors of regions; `weights` are what the regions count, and those without
// any are left out.
double boundingError(std::span<const double> errors, std::span<const double> weights);

}  // namespace lambent::baker
