#include "runtime/lighting/seen_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/lighting/prefiltered_environment.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;
constexpr int kSeenKernelBands = static_cast<int>(transfer::kSeenBands);
constexpr std::size_t kCount = transfer::kSeenWeights;
using Vector = std::array<double, kCount>;
using Matrix = std::array<Vector, kCount>;

// Narrower lobes than this are beyond what the bands can tell apart.
constexpr float kLeastRoughness = 0.3f;
// Adds this share of the mean of the diagonal to it, so that errors of the coding do not grow too much.
constexpr double kDamping = 1e-2;

// A direction of the quadrature over half of the hemisphere, whose other half is its mirror image.
struct Node {
  glm::dvec3 direction;
  double solid_angle;
  Vector functions;  // y_k max(n·s, 0)/pi for m >= 0, at l(l+1)/2 + m
};

std::vector<Node> quadrature() {
  constexpr int kHeights = 40, kAzimuths = 48;
  std::vector<Node> nodes;
  for (int i = 0; i < kHeights; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const double z = (i + 0.5) / kHeights, phi = kPi * (j + 0.5) / kAzimuths, r = std::sqrt(1.0 - z * z);
      Node node{.direction = {r * std::cos(phi), r * std::sin(phi), z},
                .solid_angle = 2.0 * kPi / (kHeights * kAzimuths),
                .functions = {}};
      std::array<double, transfer::kSeenCoefficients> y;
      sh::evaluate(kSeenKernelBands, node.direction, y);
      for (int l = 0; l < kSeenKernelBands; ++l)
        for (int m = 0; m <= l; ++m)
          node.functions[static_cast<std::size_t>(l * (l + 1) / 2 + m)] =
              y[static_cast<std::size_t>(l * (l + 1) + m)] * z / kPi;
      nodes.push_back(node);
    }
  return nodes;
}

// Returns the lower factor of Cholesky's decomposition.
Matrix factorOf(Matrix a) {
  for (std::size_t j = 0; j < kCount; ++j)
    for (std::size_t i = j; i < kCount; ++i) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  return a;
}

Vector solve(const Matrix& factor, Vector right) {
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t k = 0; k < i; ++k) right[i] -= factor[i][k] * right[k];
    right[i] /= factor[i][i];
  }
  for (std::size_t i = kCount; i-- > 0;) {
    for (std::size_t k = i + 1; k < kCount; ++k) right[i] -= factor[k][i] * right[k];
    right[i] /= factor[i][i];
  }
  return right;
}

Matrix normalMatrix(const std::vector<Node>& nodes) {
  Matrix sums{};
  for (const Node& node : nodes)
    for (std::size_t i = 0; i < kCount; ++i)
      for (std::size_t k = 0; k < kCount; ++k)
        sums[i][k] += node.solid_angle * node.functions[i] * node.functions[k];
  double trace = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) trace += sums[i][i];
  for (std::size_t i = 0; i < kCount; ++i) sums[i][i] += kDamping * trace / kCount;
  return sums;
}

// Returns the weights b for a direction at this cosine, with m >= 0.
Vector weightsFor(const std::vector<Node>& nodes, const Matrix& factor, const ReflectedLobe& lobe,
                  double cosine) {
  const glm::dvec3 mirrored(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  Vector right{}, open{};
  for (const Node& node : nodes) {
    const double density = lobe.density(static_cast<float>(glm::dot(node.direction, mirrored)));
    for (std::size_t i = 0; i < kCount; ++i) {
      right[i] += node.solid_angle * density * node.functions[i];
      open[i] += node.solid_angle * node.functions[i];
    }
  }
  Vector b = solve(factor, right);
  double all = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) all += b[i] * open[i];
  for (double& value : b) value /= all;
  return b;
}

// Returns the inverse of bundle::angleAxis.
double cosineAt(double axis) {
  const double root = 1.0 - axis * axis;
  return 1.0 - root * root;
}

}  // namespace

SeenKernel makeSeenKernel() {
  const std::vector<Node> nodes = quadrature();
  const Matrix factor = factorOf(normalMatrix(nodes));
  const sh::ZonalFactors factors = sh::ZonalFactors::isotropic(kSeenKernelBands);
  SeenKernel kernel;
  kernel.texels.assign(std::size_t{kSeenLayers} * kSeenRoughnesses * kSeenCosines, glm::vec4(0.0f));
  for (std::uint32_t r = 0; r < kSeenRoughnesses; ++r) {
    const ReflectedLobe lobe = makeReflectedLobe(
        std::max(static_cast<float>(r) / static_cast<float>(kSeenRoughnesses - 1), kLeastRoughness));
    for (std::uint32_t c = 0; c < kSeenCosines; ++c) {
      const Vector b = weightsFor(nodes, factor, lobe, cosineAt(static_cast<double>(c) / (kSeenCosines - 1)));
      std::array<float, kCount> coefficients, weights;
      std::ranges::transform(b, coefficients.begin(), [](double value) { return static_cast<float>(value); });
      factors.factor(coefficients, weights);
      for (std::size_t i = 0; i < kCount; ++i)
        kernel.texels[((i / 4) * kSeenRoughnesses + r) * kSeenCosines + c][static_cast<int>(i % 4)] =
            weights[i];
    }
  }
  return kernel;
}

}  // namespace lambent::lighting
