#include "runtime/sh/basis.hpp"

#include <algorithm>
#include <cassert>

namespace lambent::sh {

namespace {

template <int Order, typename T>
void evaluateOne(T x, T y, T z, T* out) {
  evaluateFixed<Order>(x, y, z, [out](int i, T value) { out[i] = value; });
}

// Evaluates one direction per vector lane. The ivdep pragma is valid because outputs must not overlap inputs.
template <int Order, typename T>
void evaluateMany(const T* xs, const T* ys, const T* zs, std::size_t count, T* out, std::size_t stride) {
#ifndef __clang__
#pragma GCC ivdep
#endif
  for (std::size_t k = 0; k < count; ++k)
    evaluateFixed<Order>(xs[k], ys[k], zs[k],
                         [=](int i, T value) { out[static_cast<std::size_t>(i) * stride + k] = value; });
}

}  // namespace

template <std::floating_point T>
void evaluate(int order, T x, T y, T z, std::type_identity_t<std::span<T>> out) {
  assert(out.size() >= static_cast<std::size_t>(coefficientCount(order)));
  withOrder<kMaxBasisOrder>(order, [&](auto fixed) { evaluateOne<fixed>(x, y, z, out.data()); });
}

template <std::floating_point T>
void evaluateBatch(int order, const T* xs, const T* ys, const T* zs, std::size_t count, T* out,
                   std::size_t stride) {
  assert(stride >= count);
  withOrder<kMaxBasisOrder>(order, [&](auto fixed) { evaluateMany<fixed>(xs, ys, zs, count, out, stride); });
}

template void evaluate<float>(int, float, float, float, std::span<float>);
template void evaluate<double>(int, double, double, double, std::span<double>);
template void evaluateBatch<float>(int, const float*, const float*, const float*, std::size_t, float*,
                                   std::size_t);
template void evaluateBatch<double>(int, const double*, const double*, const double*, std::size_t, double*,
                                    std::size_t);

glm::vec3 LightVector::evaluate(const glm::vec3& dir) const {
  std::array<float, kMaxCoefficients> y;
  sh::evaluate(order, dir, y);
  glm::vec3 sum(0.0f);
  for (int i = 0; i < coefficientCount(order); ++i)
    sum += c[static_cast<std::size_t>(i)] * y[static_cast<std::size_t>(i)];
  return sum;
}

LightVector LightVector::truncated(int new_order) const {
  assert(new_order >= 1 && new_order <= kMaxOrder);
  LightVector result{.order = new_order};
  const auto kept = static_cast<std::size_t>(coefficientCount(std::min(order, new_order)));
  std::copy_n(c.begin(), kept, result.c.begin());
  return result;
}

LightVector& LightVector::operator+=(const LightVector& other) {
  order = std::max(order, other.order);
  for (std::size_t i = 0; i < other.coefficients().size(); ++i) c[i] += other.c[i];
  return *this;
}

LightVector& LightVector::operator*=(float scale) {
  return *this *= glm::vec3(scale);
}

LightVector& LightVector::operator*=(const glm::vec3& scale_rgb) {
  for (glm::vec3& value : coefficients()) value *= scale_rgb;
  return *this;
}

LightVector operator+(LightVector a, const LightVector& b) {
  return a += b;
}
LightVector operator*(LightVector light, float scale) {
  return light *= scale;
}
LightVector operator*(float scale, LightVector light) {
  return light *= scale;
}
LightVector operator*(LightVector light, const glm::vec3& scale_rgb) {
  return light *= scale_rgb;
}

}  // namespace lambent::sh
