#include "runtime/sh/cube_map.hpp"

#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

namespace lambent::sh {

namespace {

// Returns the signed solid angle of [0, u] x [0, v] at distance 1.
double cornerSolidAngle(double u, double v) {
  return std::atan2(u * v, std::sqrt(u * u + v * v + 1));
}

}  // namespace

glm::dvec3 cubeFaceDirection(int face, double sc, double tc) {
  switch (face) {
    case 0:
      return {1, -tc, -sc};
    case 1:
      return {-1, -tc, sc};
    case 2:
      return {sc, 1, tc};
    case 3:
      return {sc, -1, -tc};
    case 4:
      return {sc, -tc, 1};
    case 5:
      return {-sc, -tc, -1};
  }
  assert(false && "a cube has faces 0 to 5");
  return {};
}

glm::dvec3 cubeTexelDirection(int size, int face, int x, int y) {
  return glm::normalize(cubeFaceDirection(face, 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1));
}

double cubeTexelSolidAngle(int size, int x, int y) {
  const double edge = 2.0 / size;
  return rectangleSolidAngle(-1 + x * edge, -1 + (x + 1) * edge, -1 + y * edge, -1 + (y + 1) * edge);
}

double rectangleSolidAngle(double u0, double u1, double v0, double v1) {
  return cornerSolidAngle(u1, v1) - cornerSolidAngle(u0, v1) - cornerSolidAngle(u1, v0) +
         cornerSolidAngle(u0, v0);
}

}  // namespace lambent::sh
