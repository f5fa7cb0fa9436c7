// The words for lights made real: what shines from infinity, in the lights' own frame (before
// --rotate-light). Comes in: the lights as parsed; those that stand in the scene are passed over. Goes out:
// environment maps loaded, discs, one constant, and the light vector of all of them together. The runtime and
// the reference renderer both start from here, so that they mean the same light. Errors: those of loading a
// environment map.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/environment_map.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

struct Disc {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // towards it
  float radius_rad = 0.0f;
  glm::vec3 radiance{0.0f};
};

// Bands 0..7 of all of them, in closed form.
sh::LightVector discVector(std::span<const Disc> discs);

struct DistantLights {
  std::vector<EnvironmentMap> environment_maps;
  std::vector<Disc> discs;
  glm::vec3 constant{0.0f};
  // What was repaired in the environment maps; a sentence each.
  std::vector<std::string> notices;

  // As bands 0..7: environment maps projected texel by texel, discs and the constant in closed form.
  sh::LightVector lightVector() const;  // all of it
  sh::LightVector skyVector() const;    // environment maps and the constant
};

// load: where environment maps come from.
Result<DistantLights> loadDistantLights(
    const std::vector<Light>& lights,
    const std::function<Result<EnvironmentMap>(const EnvironmentMapLight&)>& load = loadEnvironmentMap);

// Light that was turned by `degrees` about +Y, as lightRotation() turns directions.
sh::LightVector turned(const sh::LightVector& light, float degrees);

}  // namespace lambent::spec
