// Incident light as spherical harmonics: L(s) = sum_i c_i y_i(s), the radiance (linear Rec.709 RGB, float32)
// that arrives from unit direction s. The same type holds any RGB function of direction (windowed light,
// irradiance/pi). Coefficients at and above order² are zero, so vectors of different orders add as functions
// do.
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

  // L(dir) for a unit direction; may be negative where the expansion rings.
  glm::vec3 evaluate(const glm::vec3& dir) const;

  // The first bands only; a higher order than the present one pads with zeros.
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
