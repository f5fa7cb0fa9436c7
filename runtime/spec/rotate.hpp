// Rotates all lights about the vertical axis, as --rotate-light does. Positive degrees take +Z to +X about
// +Y, so D degrees move a sun at azimuth A to azimuth A + D.
#pragma once

#include <string_view>

#include <glm/mat3x3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

Result<float> parseDegrees(std::string_view word);

// Returns the matrix that rotates directions of the light.
glm::mat3 lightRotation(float degrees);

}  // namespace lambent::spec
