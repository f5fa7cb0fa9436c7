// Light from infinity as it was read last, since reading probes and making them ready to be sampled takes
// long, and most pictures that follow each other have the same light. One thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "reference/environment.hpp"
#include "reference/options.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker::reference {

class LightCache {
 public:
  using FromInfinity = std::variant<spec::EnvironmentMapLight, spec::ConstantLight, spec::SunLight>;

  // By the lights' words: a probe's file that changed since is not read again. factors, more: Request's.
  // Errors: those of loading a probe.
  Result<std::shared_ptr<const Environment>> environment(
      const std::vector<spec::Light>& lights, const std::vector<float>& factors, const Options& options,
      const std::shared_ptr<const spec::DistantLights>& more = {});
  // What was repaired in the probes.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  std::optional<std::vector<FromInfinity>> lights_;  // that loaded_ is of; none: of none
  std::vector<spec::DistantLights> loaded_;          // each, whole
  std::vector<std::string> notices_;
  std::vector<float> factors_;
  std::shared_ptr<const spec::DistantLights> more_;
  float turn_deg_ = 0.0f;
  int band_limit_ = 0;
  std::shared_ptr<const Environment> environment_;  // of all these; null: of none
};

}  // namespace lambent::baker::reference
