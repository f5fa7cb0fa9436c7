// Says what colours are in pictures: those of Rec. 709, coded by sRGB where a component is a byte.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::spec {

// Returns the luminance of linear light.
inline float luminanceOf(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

// Decodes a component (IEC 61966-2-1); both are 0..1.
inline float linearFromSrgb(float coded) {
  return coded <= 0.04045f ? coded / 12.92f : std::pow((coded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace lambent::spec
