// Integrates over a hemisphere independently of the baker: it samples no directions from the BRDF, but
// subdivides cells of directions adaptively.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/brdf/brdf.hpp"

namespace lambent::baker::testing {

constexpr double kPi = std::numbers::pi;

// Applies Gauss-Legendre quadrature with three nodes per axis to a cell [theta] x [phi], and divides it in
// four until both results agree.
class HemisphereIntegral {
 public:
  using Function = std::function<double(const glm::dvec3& s)>;  // the integrand without the factor sin(theta)

  explicit HemisphereIntegral(double tolerance) : tolerance_(tolerance) {}

  double operator()(const Function& f) const {
    double sum = 0;
    constexpr int kStart = 8;
    for (int i = 0; i < kStart; ++i)
      for (int j = 0; j < kStart; ++j) {
        const Cell cell{0.5 * kPi * i / kStart, 0.5 * kPi * (i + 1) / kStart, 2 * kPi * j / kStart,
                        2 * kPi * (j + 1) / kStart};
        sum += refined(f, cell, gauss(f, cell), 0);
      }
    return sum;
  }

 private:
  struct Cell {
    double theta0, theta1, phi0, phi1;
  };

  static double gauss(const Function& f, const Cell& cell) {
    static const std::array<double, 3> kAt = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
    static const std::array<double, 3> kWeight = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double theta = std::lerp(cell.theta0, cell.theta1, kAt[i]),
                     phi = std::lerp(cell.phi0, cell.phi1, kAt[j]);
        const double r = std::sin(theta);
        sum += kWeight[i] * kWeight[j] * r * f({r * std::cos(phi), r * std::sin(phi), std::cos(theta)});
      }
    return sum * (cell.theta1 - cell.theta0) * (cell.phi1 - cell.phi0);
  }

  double refined(const Function& f, const Cell& cell, double whole, int depth) const {
    const double theta = 0.5 * (cell.theta0 + cell.theta1), phi = 0.5 * (cell.phi0 + cell.phi1);
    const std::array<Cell, 4> parts = {{{cell.theta0, theta, cell.phi0, phi},
                                        {theta, cell.theta1, cell.phi0, phi},
                                        {cell.theta0, theta, phi, cell.phi1},
                                        {theta, cell.theta1, phi, cell.phi1}}};
    std::array<double, 4> sums{};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += sums[i] = gauss(f, parts[i]);
    // Cells start out coarser than narrow lobes, so a least depth is always used.
    if (depth >= kMost || (depth >= kLeast && std::abs(sum - whole) < tolerance_)) return sum;
    sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += refined(f, parts[i], sums[i], depth + 1);
    return sum;
  }

  static constexpr int kLeast = 2, kMost = 14;
  double tolerance_;
};

// Returns v in the frame of b(v), whose x axis points along the surface to the side where the view is.
inline glm::dvec3 localView(const bundle::BrdfView& view) {
  const double z = static_cast<double>(view.cos_theta), r = std::sqrt(1 - z * z);
  return {r * static_cast<double>(view.cos_phi), r * static_cast<double>(view.sin_phi), z};
}

}  // namespace lambent::baker::testing
