#include "baker/effects/volume/sphere_table.hpp"

#include <cmath>
#include <numbers>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

SphereTable::SphereTable(std::size_t rays, int order, const glm::dquat& turn)
    : columns_(static_cast<std::size_t>(sh::coefficientCount(order))) {
  directions_.reserve(rays);
  harmonics_.resize(rays * columns_);
  means_.assign(columns_, 0.0);
  std::vector<double> values(columns_);
  for (std::size_t r = 0; r < rays; ++r) {
    const double z = 1.0 - (2.0 * static_cast<double>(r) + 1.0) / static_cast<double>(rays);
    const double phi =
        2.0 * std::numbers::pi * std::fmod(static_cast<double>(r) * (std::numbers::phi - 1.0), 1.0);
    const double across = std::sqrt(1.0 - z * z);
    const glm::dvec3 direction = turn * glm::dvec3(across * std::cos(phi), across * std::sin(phi), z);
    directions_.emplace_back(direction);
    sh::evaluate(order, direction, std::span(values));
    for (std::size_t i = 0; i < columns_; ++i) harmonics_[r * columns_ + i] = static_cast<float>(values[i]);
    for (std::size_t i = 0; i < columns_; ++i) means_[i] += values[i] / static_cast<double>(rays);
  }
}

}  // namespace lambent::baker
