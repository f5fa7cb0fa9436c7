// Turning all lights about the vertical, as --rotate-light takes it: degrees, positive takes +Z to +X about
// +Y. A turn by D degrees moves a sun at azimuth A to azimuth A + D.
#pragma once

#include <string_view>

#include <glm/mat3x3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::spec {

Result<float> parseDegrees(std::string_view word);

// Takes a direction of the unturned light to where it stands after the turn.
glm::mat3 lightRotation(float degrees);

}  // namespace lambent::spec
