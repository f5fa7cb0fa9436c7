// A light environment map in memory: a picture of the whole sphere, its layout, and a look-up by direction.
// Comes in: a EnvironmentMapLight. Goes out: radiance towards any direction, filtered bilinearly on the
// sphere: lat-long pictures wrap and go over the poles, crosses go from face to face and never take from
// their unused squares, angular maps stay in their circle. Texels that are not finite count as black; how
// many there were is kept.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

struct EnvironmentMap {
  RgbImage image;  // every value finite
  sh::ImageLayout layout = sh::ImageLayout::LatLong;
  std::uint64_t texels_not_finite = 0;  // replaced by 0 when loaded
};

// Errors: those of readLightImage; a shape that is no known layout, or that does not fit the layout asked
// for.
Result<EnvironmentMap> loadEnvironmentMap(const EnvironmentMapLight& light);

// What arrives from the unit direction dir (light frame), bilinear.
glm::vec3 radiance(const EnvironmentMap& environment_map, glm::vec3 dir);

}  // namespace lambent::spec
