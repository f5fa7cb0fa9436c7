// The words for lights made real: what shines from infinity, in the lights' own frame (before
// --rotate-light). Comes in: the lights as parsed; those that stand in the scene are passed over. Goes out:
// probes loaded, discs, one constant, and the light vector of all of them together. The runtime and the
// reference renderer both start from here, so that they mean the same light. Errors: those of loading a
// probe.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/probe.hpp"

namespace lambent::spec {

struct Disc {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // towards it
  float radius_rad = 0.0f;
  glm::vec3 radiance{0.0f};
};

// Bands 0..7 of all of them, in closed form.
sh::LightVector discVector(std::span<const Disc> discs);

struct DistantLights {
  std::vector<Probe> probes;
  std::vector<Disc> discs;
  glm::vec3 constant{0.0f};
  // What was repaired in the probes; a sentence each.
  std::vector<std::string> notices;

  // As bands 0..7: probes projected texel by texel, discs and the constant in closed form.
  sh::LightVector lightVector() const;  // all of it
  sh::LightVector skyVector() const;    // probes and the constant
};

// load: where probes come from.
Result<DistantLights> loadDistantLights(
    const std::vector<Light>& lights,
    const std::function<Result<Probe>(const ProbeLight&)>& load = loadProbe);

// Light that was turned by `degrees` about +Y, as lightRotation() turns directions.
sh::LightVector turned(const sh::LightVector& light, float degrees);

}  // namespace lambent::spec
