#include "runtime/sh/zonal.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

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

template <typename Scale>
LightVector scaledBands(const LightVector& light, Scale&& scale) {
  LightVector result{.order = light.order};
  for (int l = 0; l < light.order; ++l) {
    const auto factor = static_cast<float>(scale(l));
    for (int m = -l; m <= l; ++m) {
      const auto i = static_cast<std::size_t>(coefficientIndex(l, m));
      result.c[i] = light.c[i] * factor;
    }
  }
  return result;
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
  std::array<double, kMaxOrder> zonal{};
  for (int l = 0; l < order; ++l) zonal[static_cast<std::size_t>(l)] = discZonal(l, angular_radius_rad);
  std::array<float, kMaxCoefficients> turned;
  rotateZonal(order, zonal, dir, turned);
  LightVector light{.order = order};
  for (std::size_t i = 0; i < light.coefficients().size(); ++i) light.c[i] = radiance_rgb * turned[i];
  return light;
}

LightVector constantLight(int order, const glm::vec3& radiance_rgb) {
  LightVector light{.order = order};
  light.c[0] = radiance_rgb * static_cast<float>(std::sqrt(4 * kPi));
  return light;
}

void rotateZonal(int order, std::span<const double> zonal, const glm::vec3& dir, std::span<float> out) {
  scaleBands(order, dir, out,
             [zonal](int l) { return convolutionFactor(l, zonal[static_cast<std::size_t>(l)]); });
}

void rotateZonal(int order, std::span<const double> zonal, const glm::dvec3& dir, std::span<double> out) {
  scaleBands(order, dir, out,
             [zonal](int l) { return convolutionFactor(l, zonal[static_cast<std::size_t>(l)]); });
}

LightVector convolved(const LightVector& light, std::span<const double> zonal) {
  assert(static_cast<int>(zonal.size()) >= light.order);
  return scaledBands(light,
                     [zonal](int l) { return convolutionFactor(l, zonal[static_cast<std::size_t>(l)]); });
}

LightVector cosineConvolved(const LightVector& light) {
  return scaledBands(light, [](int l) { return clampedCosine(l) / kPi; });
}

}  // namespace lambent::sh
