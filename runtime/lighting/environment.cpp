#include "runtime/lighting/environment.hpp"

#include "runtime/spec/rotate.hpp"

namespace lambent::lighting {

Result<Environment> Environment::create(const std::vector<spec::Light>& lights) {
  Result<spec::DistantLights> loaded = spec::loadDistantLights(lights);
  if (!loaded) return failAgain(loaded.error());
  Environment environment;
  environment.lights_ = std::move(*loaded);
  environment.unturned_ = environment.lights_.lightVector();
  environment.light_ = environment.unturned_;
  return environment;
}

glm::mat3 Environment::worldFromLight() const {
  return spec::lightRotation(turn_degrees_);
}

void Environment::setTurn(float degrees) {
  if (degrees == turn_degrees_) return;
  turn_degrees_ = degrees;
  light_ = spec::turned(unturned_, degrees);  // always from the unturned light: no error gathers over turns
  ++version_;
}

}  // namespace lambent::lighting
