#include "assets/torus_knot.hpp"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "assets/shapes.hpp"

namespace lambent::assets {

Mesh torusKnot(const TorusKnot& knot) {
  const double turn = 2 * std::numbers::pi;
  return surface(knot.cells_around, knot.cells_along, [&](double u, double v) {
    const double t = v < 1.0 ? turn * v : 0.0, around = u < 1.0 ? turn * u : 0.0;
    const double ring = knot.p * t, tube = knot.q * t;
    const glm::dvec3 outward(std::sin(ring), 0, std::cos(ring)), up(0, 1, 0);
    const double distance = knot.ring_radius + knot.torus_radius * std::cos(tube);
    const glm::dvec3 centre = distance * outward + knot.torus_radius * std::sin(tube) * up;
    const glm::dvec3 outward_dt = double(knot.p) * glm::dvec3(std::cos(ring), 0, -std::sin(ring));
    const glm::dvec3 tangent =
        glm::normalize(distance * outward_dt +
                       knot.torus_radius * double(knot.q) * (std::cos(tube) * up - std::sin(tube) * outward));
    // The curve lies on the torus, so the normal of the torus is at right angles to it, and the frame closes
    // by itself.
    const glm::dvec3 normal = std::cos(tube) * outward + std::sin(tube) * up;
    const glm::dvec3 side = glm::cross(tangent, normal);
    // The circle runs counter-clockwise about the tangent, so that du x dv points outside.
    const glm::dvec3 radial = std::cos(around) * side + std::sin(around) * glm::cross(tangent, side);
    return SurfacePoint{glm::vec3(centre + double(knot.tube_radius) * radial), glm::vec3(radial)};
  });
}

}  // namespace lambent::assets
