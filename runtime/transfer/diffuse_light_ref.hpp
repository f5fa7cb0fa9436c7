// This is the CPU twin of diffuse_light.glsl, with the same names and order of terms. Vectors are in the
// group's frame; light is given by real orthonormal coefficients of bands 0..2 (docs/conventions.md). No GL.
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace lambent::transfer::ref {

inline glm::vec3 diffuseLight(const std::array<glm::vec3, 9>& light, glm::vec3 n) {
  return 0.28209479f * light[0] + 0.32573501f * (n.y * light[1] + n.z * light[2] + n.x * light[3]) +
         0.27313711f * (n.x * n.y * light[4] + n.y * n.z * light[5] + n.x * n.z * light[7]) +
         0.07884789f * (3.0f * n.z * n.z - 1.0f) * light[6] +
         0.13656855f * (n.x * n.x - n.y * n.y) * light[8];
}

}  // namespace lambent::transfer::ref
