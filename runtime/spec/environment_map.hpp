// An EnvironmentMap is a picture of light from the whole sphere, with its layout, that is looked up by
// direction. Look-ups are filtered bilinearly on the sphere: lat-long pictures wrap around and across the
// poles, crosses filter from face to face and never use their empty squares, and angular maps stay inside
// their circle.
#pragma once

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

struct EnvironmentMap {
  RgbImage image;
  sh::ImageLayout layout = sh::ImageLayout::LatLong;
};

// Fails as readLightImage does, and if the shape of the picture belongs to no layout or not to the requested
// one.
Result<EnvironmentMap> loadEnvironmentMap(const EnvironmentMapLight& light);

// Returns the radiance that arrives from the unit direction `dir` in the light's frame.
glm::vec3 radiance(const EnvironmentMap& environment_map, glm::vec3 dir);

}  // namespace lambent::spec
