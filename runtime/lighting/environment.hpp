// The light at infinity: probes, suns and constants added up, turned together about +Y. Comes in: the lights
// as parsed. Goes out: one light vector of order 8 in world space (probes projected once when loaded, suns in
// closed form) and what the sky shows: a probe's radiance, discs, a constant. No GL. Errors: those of loading
// a probe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace lambent::lighting {

using spec::Disc;

class Environment {
 public:
  static Result<Environment> create(const std::vector<spec::Light>& lights);

  // Positive turns take +Z to +X.
  void setTurn(float degrees);
  float turnDegrees() const { return turn_degrees_; }
  // World directions from the lights' own.
  glm::mat3 worldFromLight() const;

  const sh::LightVector& light() const { return light_; }  // world space, turned
  std::uint64_t version() const { return version_; }       // rises with every turn

  const std::vector<spec::Probe>& probes() const { return lights_.probes; }
  const std::vector<Disc>& discs() const { return lights_.discs; }
  glm::vec3 constant() const { return lights_.constant; }
  // What was repaired in the probes; a sentence each.
  const std::vector<std::string>& notices() const { return lights_.notices; }

 private:
  Environment() = default;

  spec::DistantLights lights_;
  sh::LightVector unturned_, light_;
  float turn_degrees_ = 0.0f;
  std::uint64_t version_ = 1;
};

}  // namespace lambent::lighting
