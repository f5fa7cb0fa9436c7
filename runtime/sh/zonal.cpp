#include "runtime/sh/zonal.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

namespace {

// Returns the factor by which convolution with a zonal kernel of coefficient z_l scales band l.
double convolutionFactor(int l, double zonal) {
  return std::sqrt(4 * kPi / (2 * l + 1)) * zonal;
}

// Writes out_lm = scale(l) y_lm(dir).
template <typename T, typename Scale>
void scaleBands(int order, const glm::vec<3, T>& dir, std::span<T> out, Scale&& scale) {
  evaluate<T>(order, dir.x, dir.y, dir.z, out);
  for (int l = 0; l < order; ++l)
    for (int m = -l; m <= l; ++m) {
      T& value = out[static_cast<std::size_t>(coefficientIndex(l, m))];
      value = static_cast<T>(scale(l) * static_cast<double>(value));
    }
}

}  // namespace

double clampedCosine(int l) {
  assert(l >= 0);
  if (l == 0) return kPi;
  if (l == 1) return 2 * kPi / 3;
  if (l % 2 == 1) return 0;
  // A_l is 2 pi (-1)^(l/2-1) / ((l+2)(l-1)) * l! / (2^l (l/2)!²); the last factor is a product of
  // (2k-1)/(2k).
  double central = 1;
  for (int k = 1; k <= l / 2; ++k) central *= (2.0 * k - 1) / (2.0 * k);
  const double sign = (l / 2) % 2 == 1 ? 1 : -1;
  return sign * 2 * kPi / ((l + 2.0) * (l - 1.0)) * central;
}

double legendre(int l, double t) {
  double before = 1, value = t;
  if (l == 0) return before;
  for (int k = 2; k <= l; ++k) {
    const double next = ((2 * k - 1) * t * value - (k - 1) * before) / k;
    before = value;
    value = next;
  }
  return value;
}

void unoccludedTransfer(int order, const glm::vec3& normal, std::span<float> out) {
  scaleBands(order, normal, out, [](int l) { return clampedCosine(l) / kPi; });
}

void unoccludedTransfer(int order, const glm::dvec3& normal, std::span<double> out) {
  scaleBands(order, normal, out, [](int l) { return clampedCosine(l) / kPi; });
}

double discZonal(int l, double angular_radius_rad) {
  const double radius = std::clamp(angular_radius_rad, 0.0, kPi);
  const double half = std::sin(radius / 2);
  const double cap = 2 * half * half;  // 1 - cos(radius), without cancellation for small discs
  if (l == 0) return std::sqrt(kPi) * cap;
  if (radius > 0.1) {
    const double t = std::cos(radius);
    return std::sqrt(kPi / (2 * l + 1)) * (legendre(l - 1, t) - legendre(l + 1, t));
  }
  // The difference above is (2l+1) times the integral of P_l over [1 - cap, 1]. It cancels for small caps, so
  // they use the series of the integral with P_l(1-u) = sum_k (-1)^k C(l,k) C(l+k,k) (u/2)^k.
  double term = 1, sum = 1;
  for (int k = 1; k <= l; ++k) {
    term *= -(l - k + 1.0) * (l + k) / (1.0 * k * k) * (cap / 2);
    sum += term / (k + 1);
  }
  return std::sqrt(kPi * (2 * l + 1)) * cap * sum;
}

LightVector discLight(int order, const glm::vec3& dir, double angular_radius_rad,
                      const glm::vec3& radiance_rgb) {
  std::array<float, kMaxCoefficients> turned;
  scaleBands(order, dir, std::span<float>(turned),
             [&](int l) { return convolutionFactor(l, discZonal(l, angular_radius_rad)); });
  LightVector light{.order = order};
  for (std::size_t i = 0; i < light.coefficients().size(); ++i) light.c[i] = radiance_rgb * turned[i];
  return light;
}

LightVector constantLight(int order, const glm::vec3& radiance_rgb) {
  LightVector light{.order = order};
  light.c[0] = radiance_rgb * static_cast<float>(std::sqrt(4 * kPi));
  return light;
}

void rotateZonal(int order, std::span<const double> zonal, const glm::dvec3& dir, std::span<double> out) {
  scaleBands(order, dir, out,
             [zonal](int l) { return convolutionFactor(l, zonal[static_cast<std::size_t>(l)]); });
}

LightVector cosineConvolved(const LightVector& light) {
  LightVector result{.order = light.order};
  for (int l = 0; l < light.order; ++l) {
    const auto factor = static_cast<float>(clampedCosine(l) / kPi);
    for (int i = l * l; i < (l + 1) * (l + 1); ++i)
      result.c[static_cast<std::size_t>(i)] = light.c[static_cast<std::size_t>(i)] * factor;
  }
  return result;
}

namespace {

constexpr int kMaxAxes = 2 * kMaxFactoredOrder - 1;

struct AxisAngles {
  double theta_deg, phi_deg;
};

// These are the axes after z. They were found by random descent on the worst condition number of the band
// matrices y_lm(a_i) up to band 5, each with its first axes: 2.1 in the plane, 3.5 on the sphere.
// Axes for bands 6 to 8 were then added one band at a time: the
// condition numbers are 2.7, 3.7 and 2.8 in the plane, 11.7, 7.8 and 8.4 on the sphere. Opposite axes are
// equivalent, so all are on the upper side.
constexpr std::array<AxisAngles, 8> kInPlane = {{{70.877, 0},
                                                 {48.465, 180},
                                                 {35.135, 0},
                                                 {78.412, 180},
                                                 {23.305, 180},
                                                 {53.072, 0},
                                                 {63.550, 180},
                                                 {14.400, 0}}};
constexpr std::array<AxisAngles, 16> kOnSphere = {{{50.897, 336.283},
                                                   {63.950, 97.713},
                                                   {86.128, 268.301},
                                                   {52.917, 58.666},
                                                   {87.912, 117.891},
                                                   {59.783, 296.874},
                                                   {24.865, 359.535},
                                                   {26.242, 71.195},
                                                   {60.488, 272.484},
                                                   {40.970, 239.161},
                                                   {56.490, 169.457},
                                                   {77.150, 143.975},
                                                   {89.900, 46.772},
                                                   {85.606, 160.510},
                                                   {47.222, 264.439},
                                                   {31.317, 100.561}}};

glm::dvec3 directionOf(const AxisAngles& axis) {
  const double theta = axis.theta_deg * std::numbers::pi / 180, phi = axis.phi_deg * std::numbers::pi / 180;
  // In the plane y must be exactly 0, but the sine of pi in double precision is not.
  const bool in_plane = axis.phi_deg == 0 || axis.phi_deg == 180;
  return {std::sin(theta) * std::cos(phi), in_plane ? 0.0 : std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Inverts a row-major count x count matrix by elimination with row pivots.
std::vector<double> inverted(std::vector<double> matrix, std::size_t count) {
  std::vector<double> inverse(count * count);
  for (std::size_t i = 0; i < count; ++i) inverse[i * count + i] = 1;
  for (std::size_t column = 0; column < count; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < count; ++row)
      if (std::abs(matrix[row * count + column]) > std::abs(matrix[pivot * count + column])) pivot = row;
    for (std::size_t k = 0; k < count; ++k) {
      std::swap(matrix[pivot * count + k], matrix[column * count + k]);
      std::swap(inverse[pivot * count + k], inverse[column * count + k]);
    }
    const double scale = 1 / matrix[column * count + column];
    for (std::size_t k = 0; k < count; ++k)
      matrix[column * count + k] *= scale, inverse[column * count + k] *= scale;
    for (std::size_t row = 0; row < count; ++row) {
      const double factor = matrix[row * count + column];
      if (row == column || factor == 0) continue;
      for (std::size_t k = 0; k < count; ++k) {
        matrix[row * count + k] -= factor * matrix[column * count + k];
        inverse[row * count + k] -= factor * inverse[column * count + k];
      }
    }
  }
  return inverse;
}

}  // namespace

ZonalFactors::ZonalFactors(int order, bool isotropic) : order_(order), isotropic_(isotropic) {
  assert(order >= 1 && order <= kMaxFactoredOrder);
  std::vector<glm::dvec3> axes = {glm::dvec3(0, 0, 1)};
  const std::span<const AxisAngles> others = isotropic ? std::span<const AxisAngles>(kInPlane) : kOnSphere;
  for (int i = 1; i < axesOfBand(order - 1); ++i)
    axes.push_back(directionOf(others[static_cast<std::size_t>(i - 1)]));
  axes_.assign(axes.begin(), axes.end());

  std::vector<double> y(static_cast<std::size_t>(coefficientCount(order)));
  for (int l = 0; l < order; ++l) {
    // The matrix y_lm(a_i) has row m and column i. Functions with axes in the plane have only m >= 0.
    const auto count = static_cast<std::size_t>(axesOfBand(l));
    std::vector<double> band(count * count);
    for (std::size_t i = 0; i < count; ++i) {
      evaluate(order, axes[i], y);
      const auto first = static_cast<std::size_t>(coefficientIndex(l, isotropic ? 0 : -l));
      for (std::size_t m = 0; m < count; ++m) band[m * count + i] = y[first + m];
    }
    const std::vector<double> inverse = inverted(std::move(band), count);
    inverses_.insert(inverses_.end(), inverse.begin(), inverse.end());
  }
}

int ZonalFactors::weightCount() const {
  return isotropic_ ? order_ * (order_ + 1) / 2 : order_ * order_;
}

void ZonalFactors::factor(std::span<const float> coefficients, std::span<float> weights) const {
  assert(coefficients.size() >= static_cast<std::size_t>(weightCount()) &&
         weights.size() >= static_cast<std::size_t>(weightCount()));
  const double* inverse = inverses_.data();
  std::size_t first = 0;
  for (int l = 0; l < order_; ++l) {
    const auto count = static_cast<std::size_t>(axesOfBand(l));
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (std::size_t m = 0; m < count; ++m)
        sum += inverse[i * count + m] * static_cast<double>(coefficients[first + m]);
      weights[first + i] = static_cast<float>(sum);
    }
    inverse += count * count;
    first += count;
  }
}

}  // namespace lambent::sh
