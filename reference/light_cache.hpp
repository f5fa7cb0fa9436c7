// Caches the last distant light, because loading environment maps and preparing them for sampling is slow and
// successive pictures mostly have the same light. Use it from one thread.
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

// Loads the distant lights of a request, each separately, and combines them with their factors. With factors
// of 1 the result is bit-identical to that of loadDistantLights().

// Returns one entry per light; entries of lights within the scene are empty. Errors: an environment map
// cannot be loaded.
Result<std::vector<spec::DistantLights>> loadEach(const std::vector<spec::Light>& lights);

// Combines the lights. `factors` has one factor per light; missing ones are 1.
spec::DistantLights together(const std::vector<spec::DistantLights>& each, const std::vector<float>& factors);

// Adds the lights in `more`, which may be null.
void addLights(spec::DistantLights& lights, const spec::DistantLights* more);

class LightCache {
 public:
  using FromInfinity = std::variant<spec::EnvironmentMapLight, spec::ConstantLight, spec::SunLight>;

  // Returns the environment of these lights. Lights are compared by their words, so an environment map that
  // changed on disk is not loaded again. `factors` and `more` are as in Request. Errors: an environment map
  // cannot be loaded.
  Result<std::shared_ptr<const Environment>> environment(
      const std::vector<spec::Light>& lights, const std::vector<float>& factors, const Options& options,
      const std::shared_ptr<const spec::DistantLights>& more = {});
  // Returns what was repaired in the environment maps, one sentence each.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  std::optional<std::vector<FromInfinity>> lights_;  // the lights of loaded_; none if nothing is loaded
  std::vector<spec::DistantLights> loaded_;          // one per light, not band-limited
  std::vector<std::string> notices_;
  std::vector<float> factors_;
  std::shared_ptr<const spec::DistantLights> more_;
  float turn_deg_ = 0.0f;
  int band_limit_ = 0;
  std::shared_ptr<const Environment> environment_;  // built from the members above; null if there is none yet
};

}  // namespace lambent::baker::reference
