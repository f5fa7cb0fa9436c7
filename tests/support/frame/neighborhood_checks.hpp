// Makes floors and black spheres under known light, and compares pictures with them.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/brdf/brdf.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/neighborhood_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using testing::blackSphere;
using testing::BuiltBody;
using testing::BuiltReceiver;
using testing::changeOf;
using testing::floorMesh;
using testing::irradianceOverPi;
using testing::NeighborhoodScene;
using testing::NeighborhoodStage;

inline const spec::Light kWhite = spec::ConstantLight{.radiance = glm::vec3(1.0f)};
inline const spec::Light kSun = spec::SunLight{
    .azimuth_deg = 70, .elevation_deg = 50, .angle_deg = 25, .radiance = glm::vec3(6.0f, 5.0f, 4.0f)};
inline const glm::quat kTurn = glm::angleAxis(0.9f, glm::normalize(glm::vec3(1, 2, 3)));

inline BuiltReceiver floorOf(float half, int cells = 1) {
  BuiltReceiver receiver;
  receiver.name = "floor";
  receiver.mesh = floorMesh(half, cells);
  receiver.material.metallic = 0.0f;  // diffuse, so that it has no specular layer beside a bundle's table
  return receiver;
}

inline BuiltBody sphereAt(const glm::vec3& place, float radius = 1.0f,
                          const glm::uvec3& size = glm::uvec3(25), const glm::vec3& half = glm::vec3(4.0f)) {
  BuiltBody body;
  body.change = blackSphere(radius);
  body.size = size;
  body.half = half;
  body.place = place;
  return body;
}

// The floor of most tests, 1.5 below the origin, lies on a plane of grid points.
inline const glm::uvec3 kFine(33, 19, 33), kWide(41, 21, 41);
inline const glm::vec3 kFineHalf(3.0f, 4.5f, 3.0f), kWideHalf(4.5f);

using Expected = std::function<glm::vec3(const glm::vec3& place)>;

// Returns the largest difference among places within `reach` of the origin along each axis, relative to the
// expected value or to the light of the unoccluded floor.
inline double worst(const NeighborhoodStage& stage, const spec::RgbaImage& image, float reach,
                    const Expected& expected, const glm::vec3& open = glm::vec3(0.0f)) {
  double largest = 0.0;
  for (std::uint32_t y = 0; y < NeighborhoodStage::kSide; ++y)
    for (std::uint32_t x = 0; x < NeighborhoodStage::kSide; ++x) {
      const glm::vec3 place = stage.placeOf(x, y);
      if (std::max(std::abs(place.x), std::abs(place.z)) > reach) continue;
      const glm::vec3 got(image.texels[y * NeighborhoodStage::kSide + x]), wanted = expected(place);
      for (int c = 0; c < 3; ++c)
        largest =
            testing::larger(largest, std::abs(got[c] - wanted[c]) / (open[c] > 0.0f ? open[c] : wanted[c]));
    }
  return largest;
}

inline double worstDifference(const spec::RgbaImage& a, const spec::RgbaImage& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    for (int c = 0; c < 3; ++c) largest = testing::larger(largest, std::abs(a.texels[i][c] - b.texels[i][c]));
  return largest;
}

// Returns what an ideal grid gives: the unoccluded floor's light plus (M - I) l of each sphere, without
// occlusion between them.
inline Expected ideal(const lighting::Environment& environment, std::vector<glm::vec3> spheres,
                      float radius = 1.0f) {
  const sh::LightVector light = environment.light().truncated(5);
  return [light, spheres, radius](const glm::vec3& place) {
    std::vector<glm::vec3> sum(light.coefficients().begin(), light.coefficients().end());
    for (const glm::vec3& sphere : spheres) {
      const std::vector<glm::vec3> change = changeOf(light, 5, 3, blackSphere(radius)(7, place - sphere));
      for (std::size_t i = 0; i < change.size(); ++i) sum[i] += change[i];
    }
    return irradianceOverPi(sum, glm::vec3(0, 1, 0));
  };
}

inline glm::vec3 openLight(const lighting::Environment& environment) {
  return ideal(environment, {})(glm::vec3(0.0f));
}

using NeighborhoodFrame = testing::GpuTest;

}  // namespace lambent::frame
