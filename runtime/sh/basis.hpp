// The room sh owns spherical harmonics: basis, rotation, zonal functions, projection of pictures, windows,
// and lights in closed form. It computes with plain values on the CPU, and free functions may be called from
// any thread. Wrong orders and sizes are bugs, which assert; only invalid rotations are returned as an Error.
//
// This header evaluates the real spherical harmonics y_lm of all rooms. They are orthonormal over the sphere,
// WITHOUT the Condon-Shortley sign, with index i = l(l+1)+m. "Order n" means n bands, l = 0..n-1, and n²
// coefficients (docs/conventions.md). Input is a unit direction in Cartesian components, output the n²
// values. The recurrences use polynomials in x and y for cos(m phi) sin(theta)^m and sin(m phi) sin(theta)^m,
// and polynomials in z for associated Legendre functions divided by sin(theta)^m. They need no trigonometry,
// division or factorials, so the poles are ordinary points. If the length of a direction is off by e, band l
// is off by about l e.
#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>

#include <glm/vec3.hpp>

namespace lambent::sh {

inline constexpr double kPi = std::numbers::pi;

constexpr int kMaxOrder = 8;        // largest order of light and of everything that is stored for it
constexpr int kMaxBasisOrder = 13;  // largest order of basis and rotations, for 5 + 9 - 1 bands in gaunt.hpp

constexpr int coefficientCount(int order) {
  return order * order;
}
constexpr int coefficientIndex(int l, int m) {
  return l * (l + 1) + m;
}

// Returns the band l of coefficient i.
constexpr int bandOf(int i) {
  int l = 0;
  while ((l + 1) * (l + 1) <= i) ++l;
  return l;
}

constexpr int kMaxCoefficients = coefficientCount(kMaxOrder);

// Writes all order² values at a unit direction to `out`, which holds at least as many. `order` is in
// 1..kMaxBasisOrder.
template <std::floating_point T>
void evaluate(int order, T x, T y, T z, std::type_identity_t<std::span<T>> out);

inline void evaluate(int order, const glm::vec3& dir, std::span<float> out) {
  evaluate<float>(order, dir.x, dir.y, dir.z, out);
}
inline void evaluate(int order, const glm::dvec3& dir, std::span<double> out) {
  evaluate<double>(order, dir.x, dir.y, dir.z, out);
}

// Evaluates many directions at once: y_i of direction k goes to out[i * stride + k], where stride >= count.
// Outputs must not overlap inputs. Values agree with evaluate() up to rounding.
template <std::floating_point T>
void evaluateBatch(int order, const T* xs, const T* ys, const T* zs, std::size_t count, T* out,
                   std::size_t stride);

template <std::floating_point T>
void evaluateBatch(int order, const T* xs, const T* ys, const T* zs, std::size_t count, T* out) {
  evaluateBatch(order, xs, ys, zs, count, out, count);
}

namespace detail {

// std::sqrt is not constexpr in C++20. Newton's method starts above the root and decreases until rounding
// stops it.
constexpr double constexprSqrt(double value) {
  if (value <= 0) return 0;
  double root = value > 1 ? value : 1;
  for (double next = 0.5 * (root + value / root); next < root; next = 0.5 * (root + value / root))
    root = next;
  return root;
}

// Returns K_mm P_mm / sin(theta)^m without the factor sqrt(2) of functions with m != 0.
constexpr double sectoral(int m) {
  double squared = 1 / (4 * kPi);
  for (int k = 1; k <= m; ++k) squared *= (2.0 * k + 1) / (2.0 * k);
  return constexprSqrt(squared);
}
constexpr double zFactor(int l, int m) {
  return constexprSqrt((4.0 * l * l - 1) / (1.0 * l * l - m * m));
}
constexpr double backFactor(int l, int m) {
  return zFactor(l, m) * constexprSqrt(((l - 1.0) * (l - 1.0) - m * m) / (4.0 * (l - 1.0) * (l - 1.0) - 1));
}

template <int... I, typename F>
constexpr void unrolled(std::integer_sequence<int, I...>, F&& f) {
  (f(std::integral_constant<int, I>{}), ...);
}

}  // namespace detail

// Evaluates an order that is known at compile time, to be inlined into loops. Calls sink(i, y_i) once for
// each i, in columns of equal |m|. T may be any type that has +, - and * and can be constructed from double.
template <int Order, typename T, typename Sink>
inline void evaluateFixed(T x, T y, T z, Sink&& sink) {
  static_assert(Order >= 1 && Order <= kMaxBasisOrder);
  const T z_squared = z * z;
  T c = T(1), s = T(0);  // real and imaginary part of (x + iy)^m
  detail::unrolled(std::make_integer_sequence<int, Order>{}, [&](auto m_constant) {
    constexpr int m = m_constant;
    if constexpr (m == 1) {
      c = x;
      s = y;
    } else if constexpr (m > 1) {
      const T next = c * x - s * y;
      s = s * x + c * y;
      c = next;
    }
    // The polynomials in z are written out for k = l - m = 0..3; a three-term recurrence gives the others.
    constexpr double k0 = detail::sectoral(m) * (m == 0 ? 1 : detail::constexprSqrt(2));
    constexpr double k1 = detail::zFactor(m + 1, m) * k0;
    constexpr double k2 = detail::zFactor(m + 2, m) * k1, k2_constant = -detail::backFactor(m + 2, m) * k0;
    constexpr double k3 = detail::zFactor(m + 3, m) * k2;
    constexpr double k3_linear = detail::zFactor(m + 3, m) * k2_constant - detail::backFactor(m + 3, m) * k1;
    T p = T(k0), before = T(0);
    detail::unrolled(std::make_integer_sequence<int, Order - m>{}, [&](auto k_constant) {
      constexpr int k = k_constant, l = m + k;
      T next = p;
      if constexpr (k == 1) next = T(k1) * z;
      if constexpr (k == 2) next = T(k2) * z_squared + T(k2_constant);
      if constexpr (k == 3) next = z * (T(k3) * z_squared + T(k3_linear));
      if constexpr (k > 3) next = T(detail::zFactor(l, m)) * z * p - T(detail::backFactor(l, m)) * before;
      before = p;
      p = next;
      sink(coefficientIndex(l, m), m == 0 ? p : p * c);
      if constexpr (m > 0) sink(coefficientIndex(l, -m), p * s);
    });
  });
}

extern template void evaluate<float>(int, float, float, float, std::span<float>);
extern template void evaluate<double>(int, double, double, double, std::span<double>);
extern template void evaluateBatch<float>(int, const float*, const float*, const float*, std::size_t, float*,
                                          std::size_t);
extern template void evaluateBatch<double>(int, const double*, const double*, const double*, std::size_t,
                                           double*, std::size_t);

// Turns an order that is known at run time into a compile-time constant: calls f with
// std::integral_constant<int, order>. `order` is in 1..Most.
template <int Most, typename F>
void withOrder(int order, F&& f) {
  assert(order >= 1 && order <= Most);
  detail::unrolled(std::make_integer_sequence<int, Most>{}, [&](auto index) {
    if (order == index + 1) f(std::integral_constant<int, index + 1>{});
  });
}

// A LightVector is incident light in spherical harmonics: L(s) = sum_i c_i y_i(s) is the radiance (linear
// Rec.709 RGB) that arrives from unit direction s. The same type holds any RGB function of direction, such as
// windowed light or irradiance/pi. Coefficients from order² on are zero, so vectors of different orders can
// be added.
struct LightVector {
  int order = 5;
  std::array<glm::vec3, kMaxCoefficients> c{};

  std::span<const glm::vec3> coefficients() const {
    return std::span(c).first(static_cast<std::size_t>(coefficientCount(order)));
  }
  std::span<glm::vec3> coefficients() {
    return std::span(c).first(static_cast<std::size_t>(coefficientCount(order)));
  }

  // Returns L(dir) for a unit direction. It may be negative where the expansion rings.
  glm::vec3 evaluate(const glm::vec3& dir) const;

  // Returns the first new_order bands, padded with zeros if the order rises.
  LightVector truncated(int new_order) const;

  LightVector& operator+=(const LightVector& other);  // the order becomes the larger of the two
  LightVector& operator*=(float scale);
  LightVector& operator*=(const glm::vec3& scale_rgb);
};

LightVector operator+(LightVector a, const LightVector& b);
LightVector operator*(LightVector light, float scale);
LightVector operator*(float scale, LightVector light);
LightVector operator*(LightVector light, const glm::vec3& scale_rgb);

}  // namespace lambent::sh
