#include "baker/effects/diffuse/incident_basis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;

constexpr std::array<double, 3> kCosineOverPi = {1.0, 2.0 / 3.0, 0.25};  // A_l / pi
constexpr std::array<int, 6> kZonalPart = {0, 2, 3, 6, 7, 8};            // (l, m >= 0): 00 10 11 20 21 22

// Returns the kernel at a normal, (A_l/pi) y_j(n').
Vector9 kernelAt(const glm::dvec3& n) {
  Vector9 kernel;
  sh::evaluate<double>(3, n.x, n.y, n.z, std::span(kernel.data(), kIncident));
  for (int j = 0; j < 9; ++j) kernel(j) *= kCosineOverPi[static_cast<std::size_t>(sh::bandOf(j))];
  return kernel;
}

}  // namespace

IncidentBasis::IncidentBasis() {
  // Normals follow a product rule over the upper hemisphere; the integrand is smooth but for the clamp.
  constexpr int kRings = 96, kSpokes = 96;
  Eigen::Matrix<double, 9, 9> gram = Eigen::Matrix<double, 9, 9>::Zero();
  struct Node {
    glm::dvec3 n;
    double weight;
    Vector9 kernel;
  };
  std::vector<Node> nodes;
  for (int r = 0; r < kRings; ++r)
    for (int p = 0; p < kSpokes; ++p) {
      const double z = (r + 0.5) / kRings, phi = 2.0 * std::numbers::pi * (p + 0.5) / kSpokes;
      const double side = std::sqrt(1.0 - z * z);
      Node node{{side * std::cos(phi), side * std::sin(phi), z}, z * z, {}};
      node.kernel = kernelAt(node.n);
      gram += node.weight * node.kernel * node.kernel.transpose();
      nodes.push_back(node);
    }
  // This solves least squares under the constraint kernel(z) · c = s.z / pi; the tenth row is that of its
  // Lagrange multiplier.
  const Vector9 own = kernelAt({0.0, 0.0, 1.0});
  const double scale = gram.trace();
  Eigen::Matrix<double, 10, 10> system = Eigen::Matrix<double, 10, 10>::Zero();
  system.topLeftCorner<9, 9>() = gram / scale;
  system.topRightCorner<9, 1>() = own;
  system.bottomLeftCorner<1, 9>() = own.transpose();
  const Eigen::FullPivLU<Eigen::Matrix<double, 10, 10>> solver(system);
  for (std::size_t step = 0; step <= kSteps; ++step) {
    const double z = static_cast<double>(step) / kSteps;
    const glm::dvec3 s(std::sqrt(std::max(0.0, 1.0 - z * z)), 0.0, z);
    Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
    for (const Node& node : nodes) {
      const double cosine = node.n.x * s.x + node.n.z * s.z;
      if (cosine > 0.0) right.head<9>() += (node.weight / scale) * (cosine / std::numbers::pi) * node.kernel;
    }
    right(9) = z / std::numbers::pi;
    const Eigen::Matrix<double, 10, 1> solved = solver.solve(right);
    for (std::size_t k = 0; k < kZonalPart.size(); ++k)
      curves_[step][k] = static_cast<float>(solved(kZonalPart[k]));
  }
}

std::array<float, kIncident> IncidentBasis::evaluate(glm::vec3 s) const {
  const float at = std::clamp(s.z, 0.0f, 1.0f) * static_cast<float>(kSteps);
  const auto step = std::min(static_cast<std::size_t>(at), kSteps - 1);
  const float f = at - static_cast<float>(step);
  std::array<float, 6> c;
  for (std::size_t k = 0; k < c.size(); ++k) c[k] = (1.0f - f) * curves_[step][k] + f * curves_[step + 1][k];
  const float side = std::sqrt(s.x * s.x + s.y * s.y);
  const float cos1 = side > 0.0f ? s.x / side : 1.0f, sin1 = side > 0.0f ? s.y / side : 0.0f;
  const float cos2 = cos1 * cos1 - sin1 * sin1, sin2 = 2.0f * cos1 * sin1;
  // The index is l(l+1)+m; m < 0 stands for the sine.
  return {c[0], sin1 * c[2], c[1], cos1 * c[2], sin2 * c[5], sin1 * c[4], c[3], cos1 * c[4], cos2 * c[5]};
}

}  // namespace lambent::baker
