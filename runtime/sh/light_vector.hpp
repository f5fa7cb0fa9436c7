// A LightVector is incident light in spherical harmonics: L(s) = sum_i c_i y_i(s) is the radiance (linear
// Rec.709 RGB) that arrives from unit direction s. The same type holds any RGB function of direction, such as
// windowed light or irradiance/pi. Coefficients from order² on are zero, so vectors of different orders can
// be added.
#pragma once

#include <array>
#include <span>

#include <glm/vec3.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::sh {

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
