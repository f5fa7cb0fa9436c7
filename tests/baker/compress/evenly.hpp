// Makes importances for tests in which errors of all samples count alike.
#pragma once

#include <vector>

#include "baker/compress/cpca_clusters.hpp"

namespace lambent::baker {

inline std::vector<float> evenly(const Points& points) {
  return std::vector<float>(static_cast<std::size_t>(points.cols()), 1.0f);
}

}  // namespace lambent::baker
