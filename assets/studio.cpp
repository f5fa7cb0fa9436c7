#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "assets/environment_maps.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::assets {

namespace {

// A SoftBox is a rectangle on the sphere's tangent plane at its centre, with a soft rim like diffusing cloth.
struct SoftBox {
  glm::dvec3 centre, right, up;
  double half_width, half_height;  // on the plane at distance 1
  glm::dvec3 radiance;

  SoftBox(float azimuth_deg, float elevation_deg, double width_deg, double height_deg, glm::dvec3 colour)
      : centre(spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg)),
        right(spec::directionFromAzimuthElevation(azimuth_deg + 90.0f, 0.0f)),
        up(glm::cross(centre, right)),
        half_width(std::tan(width_deg * std::numbers::pi / 360)),
        half_height(std::tan(height_deg * std::numbers::pi / 360)),
        radiance(colour) {}

  glm::dvec3 seenAlong(glm::dvec3 dir) const {
    constexpr double kRim = 0.06;
    const double distance = glm::dot(dir, centre);
    if (distance <= 0.0) return glm::dvec3(0.0);
    const double x = std::abs(glm::dot(dir, right)) / distance, y = std::abs(glm::dot(dir, up)) / distance;
    const double inside = (1 - glm::smoothstep(half_width - kRim, half_width + kRim, x)) *
                          (1 - glm::smoothstep(half_height - kRim, half_height + kRim, y));
    // A lamp behind the cloth makes it brightest in the middle.
    return radiance * inside *
           (1.0 - 0.3 * (x * x / (half_width * half_width) + y * y / (half_height * half_height)) / 2);
  }
};

}  // namespace

spec::RgbImage studioMap(std::uint32_t width) {
  const std::array<SoftBox, 3> boxes = {{
      {48.0f, 40.0f, 54.0, 42.0, {16.0, 12.6, 8.8}},  // key: warm, from the right in front
      {-62.0f, 24.0f, 46.0, 62.0, {2.6, 3.5, 5.0}},   // fill: large and cool, from the left
      {172.0f, 58.0f, 70.0, 24.0, {7.0, 7.0, 6.8}},   // rim: neutral, from behind and above
  }};
  spec::RgbImage image = latLongImage(width, 4, [&](glm::dvec3 dir) {
    // Dark grey walls get a little lighter towards the ceiling; the floor reflects some warm light.
    glm::dvec3 sum = glm::mix(glm::dvec3(0.16, 0.14, 0.12), glm::dvec3(0.10, 0.10, 0.11),
                              glm::smoothstep(-0.35, 0.05, dir.y));
    sum += glm::dvec3(0.06) * glm::smoothstep(0.3, 1.0, dir.y);
    for (const SoftBox& box : boxes) sum += box.seenAlong(dir);
    return sum;
  });
  normalise(image);
  return image;
}

}  // namespace lambent::assets
