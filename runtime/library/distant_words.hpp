// Understands the words of lights at infinity, for a LightVector and for a Scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lambent/result.hpp"
#include "runtime/library/convert.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::library {

// Fails if a word is wrong, or names a light that stands in the scene, which `refused` then says.
inline Expected<std::vector<spec::Light>> distantLights(const std::vector<std::string>& words,
                                                        const Failure& refused) {
  Result<std::vector<spec::Light>> lights = spec::parseLights(words);
  if (!lights) return failureOf(lights.error());
  if (!spec::localLights(*lights).empty()) return refused;
  return std::move(*lights);
}

}  // namespace lambent::library
