// Loads the lights at infinity among the parsed lights, and skips local lights. The result has environment
// maps, discs and one constant, in the lights' own frame (before --rotate-light), and computes the light
// vector of them all. The runtime and the reference renderer both use it, so they have the same light.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

// An EnvironmentMap is a picture of light from the whole sphere, with its layout, that is looked up by
// direction. Look-ups are filtered bilinearly on the sphere: lat-long pictures wrap around and across the
// poles, crosses filter from face to face and never use their empty squares, and angular maps stay inside
// their circle.

struct EnvironmentMap {
  RgbImage image;
  sh::ImageLayout layout = sh::ImageLayout::LatLong;
};

// Fails as readLightImage does, and if the shape of the picture belongs to no layout or not to the requested
// one.
Result<EnvironmentMap> loadEnvironmentMap(const EnvironmentMapLight& light);

// Returns the radiance that arrives from the unit direction `dir` in the light's frame.
glm::vec3 radiance(const EnvironmentMap& environment_map, glm::vec3 dir);

// Describes a disc of uniform radiance at infinity.
struct Disc {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // unit, towards the disc
  float radius_rad = 0.0f;
  glm::vec3 radiance{0.0f};
  bool operator==(const Disc&) const = default;
};

// Returns bands 0..7 of the sum of the discs, in closed form.
sh::LightVector discVector(std::span<const Disc> discs);

struct DistantLights {
  std::vector<EnvironmentMap> environment_maps;
  std::vector<Disc> discs;
  glm::vec3 constant{0.0f};
  // Sentences about what is odd in files of environment maps, and what was made of it.
  std::vector<std::string> notices;

  // Returns bands 0..7, with environment maps projected texel by texel and discs and the constant in closed
  // form.
  sh::LightVector lightVector() const;
};

// Loads environment maps with `load` and passes its errors on.
Result<DistantLights> loadDistantLights(
    const std::vector<Light>& lights,
    const std::function<Result<EnvironmentMap>(const EnvironmentMapLight&)>& load = loadEnvironmentMap);

// Returns the light rotated by `degrees` about +Y, as lightRotation() rotates directions.
sh::LightVector turned(const sh::LightVector& light, float degrees);

}  // namespace lambent::spec
