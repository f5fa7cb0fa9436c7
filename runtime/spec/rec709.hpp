// Says what colours are in pictures: those of Rec. 709, coded by sRGB where a component is a byte.
#pragma once

#include <cmath>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
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

// Converts linear colours of other primaries, as pictures name them, to those of Rec. 709.

// CIE xy of the primaries and of white.
struct Primaries {
  glm::dvec2 red{0.64, 0.33}, green{0.30, 0.60}, blue{0.15, 0.06}, white{0.3127, 0.3290};  // Rec. 709
};

// Returns the matrix to Rec. 709, by which white stays white: exactly the identity for primaries that differ
// from those of Rec. 709 by no more than rounding, or nothing if they span no colours.
std::optional<glm::mat3> rec709From(const Primaries& primaries);

// Returns the matrix from CIE XYZ, which has no white, so that none is adapted.
glm::mat3 rec709FromXyz();

}  // namespace lambent::spec
