// The real spherical harmonics y_lm that every room of Lambent uses: orthonormal over the sphere, WITHOUT the
// Condon-Shortley sign, index i = l(l+1)+m. "Order n" means n bands, l = 0..n-1, n² coefficients
// (docs/conventions.md). In: unit directions as Cartesian components. Out: the n² values. There is no
// trigonometry and no division, so the poles are ordinary points; a direction that is off unit length by e
// shifts band l by about l e. Recurrences: cos(m phi) sin(theta)^m and sin(m phi) sin(theta)^m as polynomials
// in x and y, associated Legendre functions divided by sin(theta)^m as polynomials in z, with normalised
// ratios only (no factorials).
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include <glm/vec3.hpp>

namespace lambent::sh {

constexpr int kMaxOrder = 8;  // of light and everything that is stored for it
constexpr int kMaxBasisOrder =
    13;  // of the functions and rotations: visibility in 5 + 9 - 1 bands (gaunt.hpp)

constexpr int coefficientCount(int order) {
  return order * order;
}
constexpr int coefficientIndex(int l, int m) {
  return l * (l + 1) + m;
}

// The band l that coefficient i belongs to.
constexpr int bandOf(int i) {
  int l = 0;
  while ((l + 1) * (l + 1) <= i) ++l;
  return l;
}

constexpr int kMaxCoefficients = coefficientCount(kMaxOrder);

// All n² values at one unit direction; out holds at least n² entries. order in 1..kMaxBasisOrder.
template <std::floating_point T>
void evaluate(int order, T x, T y, T z, std::type_identity_t<std::span<T>> out);

inline void evaluate(int order, const glm::vec3& dir, std::span<float> out) {
  evaluate<float>(order, dir.x, dir.y, dir.z, out);
}
inline void evaluate(int order, const glm::dvec3& dir, std::span<double> out) {
  evaluate<double>(order, dir.x, dir.y, dir.z, out);
}

// Many directions at once: y_i of direction k goes to out[i * stride + k]. stride >= count; the outputs must
// not overlap the inputs. Values agree with evaluate() to rounding.
template <std::floating_point T>
void evaluateBatch(int order, const T* xs, const T* ys, const T* zs, std::size_t count, T* out,
                   std::size_t stride);

template <std::floating_point T>
void evaluateBatch(int order, const T* xs, const T* ys, const T* zs, std::size_t count, T* out) {
  evaluateBatch(order, xs, ys, zs, count, out, count);
}

namespace detail {

// std::sqrt is not constexpr in C++20. Newton from above decreases until rounding stops it.
constexpr double constexprSqrt(double value) {
  if (value <= 0) return 0;
  double root = value > 1 ? value : 1;
  for (double next = 0.5 * (root + value / root); next < root; next = 0.5 * (root + value / root))
    root = next;
  return root;
}

constexpr double kPi = 3.14159265358979323846;

// K_mm P_mm / sin(theta)^m, with the sqrt(2) of the m != 0 functions left out.
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

// evaluate() for an order known at compile time, to be inlined into loops: sink(i, y_i) is called once for
// each i, in columns of equal |m|. T may be any type with +, -, * among itself and construction from double.
template <int Order, typename T, typename Sink>
inline void evaluateFixed(T x, T y, T z, Sink&& sink) {
  static_assert(Order >= 1 && Order <= kMaxBasisOrder);
  const T z_squared = z * z;
  T c = T(1), s = T(0);  // Re and Im of (x + iy)^m
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
    // The column's polynomials in z: k = l - m = 0..3 written out, the rest by three-term recurrence.
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

}  // namespace lambent::sh
