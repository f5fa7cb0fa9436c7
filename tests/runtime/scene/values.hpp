// Values that several tests of transforms use.
#pragma once

#include <glm/vec3.hpp>

namespace lambent::testing {

// Numbers of size 1 to 10 are rounded a few times; 1e-5 is ten times the errors observed.
inline constexpr float kRounding = 1e-5f;
inline constexpr glm::vec3 kUp(0.0f, 1.0f, 0.0f);

}  // namespace lambent::testing
