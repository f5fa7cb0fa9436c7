#include "runtime/sh/local_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::sh {

namespace {

template <typename Coefficient>
LightVector scaled(int order, const glm::vec3& rgb, Coefficient&& coefficient) {
  LightVector light{.order = order};
  for (int i = 0; i < coefficientCount(order); ++i)
    light.c[static_cast<std::size_t>(i)] = glm::vec3(glm::dvec3(rgb) * coefficient(i));
  return light;
}

// Holds a value and its derivative along one direction, for forward differentiation.
struct Dual {
  double value, slope;
  constexpr Dual(double v, double s = 0.0) : value(v), slope(s) {}
  friend constexpr Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.slope + b.slope}; }
  friend constexpr Dual operator-(Dual a, Dual b) { return {a.value - b.value, a.slope - b.slope}; }
  friend constexpr Dual operator*(Dual a, Dual b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
};

// Adds the derivative of y_i at s along the tangent `along` to sums_i. It differentiates the polynomials of
// evaluateFixed(); other extensions of y_i off the sphere would have the same tangential derivative.
using Sums = std::array<double, kMaxCoefficients>;
void addSlopes(int order, const glm::dvec3& s, const glm::dvec3& along, Sums& sums) {
  withOrder<kMaxOrder>(order, [&](auto fixed) {
    evaluateFixed<fixed>(Dual(s.x, along.x), Dual(s.y, along.y), Dual(s.z, along.z),
                         [&](int i, const Dual& y) { sums[static_cast<std::size_t>(i)] += y.slope; });
  });
}

// Describes a disc in units of its radius, in a frame whose origin is the point. The disc lies in the plane
// at distance `height` ahead, and its centre is `aside` along u.
struct DiscSight {
  double height, aside;
  glm::dvec3 u, v, ahead;  // right-handed
};

// If the point is nearer to the rim than this, in radii, it is treated as this high above the plane.
constexpr double kLeastHeightAtRim = 1e-4;
// Beyond this distance, in radii, the extent of a disc makes no difference in double precision.
constexpr double kFar = 1e7;

std::optional<DiscSight> sightOf(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
  const double length = glm::length(normal);
  if (!(radius > 0.0) || !std::isfinite(radius) || !(length > 0.0) || !isFinite(normal) || !isFinite(center))
    return std::nullopt;
  DiscSight sight;
  sight.ahead = -normal / length;
  const glm::dvec3 relative = center / radius;
  sight.height = glm::dot(relative, sight.ahead);
  const glm::dvec3 beside = relative - sight.height * sight.ahead;
  sight.aside = glm::length(beside);
  const glm::dvec3 a = std::abs(sight.ahead.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  sight.u = sight.aside > 1e-12 ? beside / sight.aside : glm::cross(sight.ahead, a);
  sight.u = glm::normalize(sight.u - glm::dot(sight.u, sight.ahead) * sight.ahead);
  sight.v = glm::cross(sight.ahead, sight.u);
  if (!(sight.height > 0.0)) return std::nullopt;
  if (std::hypot(sight.height, sight.aside - 1.0) < kLeastHeightAtRim)
    sight.height = std::max(sight.height, kLeastHeightAtRim);
  return sight;
}

// Calls f(q, dq) for positions q(phi) on the rim at the nodes of a trapezoid rule, where dq = q'(phi) dphi.
// They run counter-clockwise as seen from the lit point.
//
// The rule converges as e^(-count d) if the integrand is analytic for |Im phi| < d. The integrand has a
// singularity where |q|² = A + B cos(phi) vanishes, at phi = pi + i acosh(A/B), which is near the real axis
// when the point is near the rim. The Moebius map e^(i phi) = (w + g) / (1 + g w) of the circle gathers nodes
// there. It moves this singularity and the one at e^(i phi) = 0 to equal distances, so d grows to about its
// square root.
template <typename F>
void alongRim(const DiscSight& sight, int order, F&& f) {
  const double a = sight.height * sight.height + sight.aside * sight.aside + 1.0, b = 2.0 * sight.aside;
  // This computes e^(-acosh(A/B)), with A² - B² free of cancellation.
  const double inner = (sight.aside - 1.0) * (sight.aside - 1.0) + sight.height * sight.height;
  const double outer = (sight.aside + 1.0) * (sight.aside + 1.0) + sight.height * sight.height;
  const double pole = b / (a + std::sqrt(inner * outer));
  const double g = -pole / (1.0 + std::sqrt(std::max(0.0, 1.0 - pole * pole)));
  // ln(1/|g|) gives the number of nodes. An exponent of 40 leaves an error of about e^-40 = 4e-18.
  const double decay = g < 0.0 ? -std::log(-g) : 40.0;
  const int count = 2 * order + 8 + static_cast<int>(std::ceil(std::min(40.0 / decay, 8192.0)));
  for (int k = 0; k < count; ++k) {
    const double t = 2.0 * kPi * (k + 0.5) / count, cos_t = std::cos(t), sin_t = std::sin(t);
    const double denominator = 1.0 + g * g + 2.0 * g * cos_t;
    const double cos_phi = ((1.0 + g * g) * cos_t + 2.0 * g) / denominator;
    const double sin_phi = (1.0 - g * g) * sin_t / denominator;
    const double step = (1.0 - g * g) / denominator * 2.0 * kPi / count;
    f(glm::dvec3(sight.aside + cos_phi, sin_phi, sight.height), step * glm::dvec3(-sin_phi, cos_phi, 0.0));
  }
}

}  // namespace

LightVector sphereLight(int order, const glm::dvec3& center, double radius, const glm::vec3& radiance) {
  if (!(radius > 0.0) || !isFinite(center)) return {.order = order};
  const double distance = glm::length(center);
  if (distance <= radius) return constantLight(order, radiance);
  const double angle = std::asin(radius / distance);
  std::array<double, kMaxOrder> zonal{};
  for (int l = 0; l < order; ++l) zonal[static_cast<std::size_t>(l)] = discZonal(l, angle);
  std::array<double, kMaxCoefficients> turned;
  rotateZonal(order, zonal, center / distance, std::span<double>(turned));
  return scaled(order, radiance, [&](int i) { return turned[static_cast<std::size_t>(i)]; });
}

LightVector discAreaLight(int order, const glm::dvec3& center, const glm::dvec3& normal, double radius,
                          const glm::vec3& radiance) {
  const auto sight = sightOf(center, normal, radius);
  if (!sight) return {.order = order};
  Sums sums{};
  const double distance = std::hypot(sight->height, sight->aside);
  if (distance > kFar) {
    // A distant disc is one direction with a solid angle of area times cosine over squared distance.
    const double solid_angle = kPi / distance / distance * (sight->height / distance);
    evaluate(order, glm::normalize(center), sums);
    return scaled(order, radiance, [&](int i) { return solid_angle * sums[static_cast<std::size_t>(i)]; });
  }
  // On the sphere the Laplacian of y_lm is -l(l+1) y_lm. By the divergence theorem the integral of y_lm over
  // the solid angle of the disc is therefore -1/(l(l+1)) times the integral, along the rim, of the outward
  // slope. Its direction is dq x q / |q|² for a rim seen counter-clockwise. Band 0 is the solid angle, which
  // is the integral of (1 - cos theta) dphi about the axis.
  const glm::dmat3 frame(sight->u, sight->v, sight->ahead);
  double solid_angle = 0.0;
  alongRim(*sight, order, [&](const glm::dvec3& q, const glm::dvec3& dq) {
    const double squared = glm::dot(q, q), length = std::sqrt(squared);
    solid_angle += (q.x * dq.y - q.y * dq.x) / (length * (length + sight->height));
    addSlopes(order, frame * (q / length), frame * (glm::cross(dq, q) / squared), sums);
  });
  sums[0] = solid_angle / std::sqrt(4.0 * kPi);
  for (int i = 1; i < coefficientCount(order); ++i) {
    const double l = bandOf(i);
    sums[static_cast<std::size_t>(i)] /= -l * (l + 1.0);
  }
  return scaled(order, radiance, [&](int i) { return sums[static_cast<std::size_t>(i)]; });
}

LightVector pointLight(int order, const glm::dvec3& light, const glm::vec3& intensity, double range) {
  if (!isFinite(light)) return {.order = order};
  const double distance = glm::length(light), from = std::max(distance, kLeastPointDistance);
  const double irradiance = rangeFade(from, range) / (from * from);
  const double nearness = distance / from;
  std::array<double, kMaxCoefficients> y;
  evaluate(order, distance > 0.0 ? light / distance : glm::dvec3(0, 0, 1), y);
  return scaled(order, intensity, [&](int i) {
    return irradiance * y[static_cast<std::size_t>(i)] * std::pow(nearness, bandOf(i));
  });
}

LightVector spotLight(int order, const glm::dvec3& light, const SpotCone& cone, const glm::vec3& intensity,
                      double range) {
  const double length = glm::length(cone.axis), distance = glm::length(light);
  if (!(length > 0.0) || !isFinite(cone.axis) || !isFinite(light)) return {.order = order};
  const double cosine = distance > 0.0 ? glm::dot(cone.axis / length, -light / distance) : 1.0;
  const double fade = coneFade(cosine, cone.inner_rad, cone.outer_rad);
  if (!(fade > 0.0)) return {.order = order};
  return pointLight(order, light, intensity, range) * static_cast<float>(fade);
}

LightVector directionalLight(int order, const glm::dvec3& to_light, const glm::vec3& irradiance) {
  const double length = glm::length(to_light);
  if (!(length > 0.0) || !isFinite(to_light)) return {.order = order};
  std::array<double, kMaxCoefficients> y;
  evaluate(order, to_light / length, y);
  return scaled(order, irradiance, [&](int i) { return y[static_cast<std::size_t>(i)]; });
}

double rangeFade(double distance, double range) {
  if (!(range > 0.0)) return 1.0;
  const double share = distance / range, squared = share * share;
  return std::clamp(1.0 - squared * squared, 0.0, 1.0);
}

double coneFade(double cosine, double inner_cone, double outer_cone) {
  const double cos_outer = std::cos(outer_cone);
  const double scale = 1.0 / std::max(0.001, std::cos(inner_cone) - cos_outer);
  const double inside = std::clamp((cosine - cos_outer) * scale, 0.0, 1.0);
  return inside * inside;
}

}  // namespace lambent::sh
