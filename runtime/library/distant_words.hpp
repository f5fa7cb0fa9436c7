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
  std::vector<spec::Light> lights;
  for (const std::string& word : words) {
    Result<spec::Light> light = spec::parseLight(word);
    if (!light) return failureOf(light.error());
    lights.push_back(std::move(*light));
  }
  if (!spec::localLights(lights).empty()) return refused;
  return lights;
}

}  // namespace lambent::library
