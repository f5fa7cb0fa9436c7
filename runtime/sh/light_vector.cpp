#include "runtime/sh/light_vector.hpp"

#include <algorithm>
#include <cassert>

namespace lambent::sh {

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
