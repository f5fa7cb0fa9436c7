// Converts linear colours of other primaries, as pictures name them, to those of Rec. 709.
#pragma once

#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace lambent::spec {

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
