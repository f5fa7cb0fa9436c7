// Converts between the values that the library shows and those of the rooms.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "lambent/math.hpp"
#include "lambent/result.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::library {

inline Failure failureOf(Error error) {
  return {std::move(error.subject), std::move(error.problem), std::move(error.hint)};
}

inline glm::vec3 toGlm(const Vec3& v) {
  return {v.x, v.y, v.z};
}
inline Vec3 fromGlm(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
inline glm::mat4 toGlm(const Matrix4& m) {
  return glm::make_mat4(m.data());
}
inline Matrix4 fromGlm(const glm::mat4& m) {
  Matrix4 result;
  std::copy_n(glm::value_ptr(m), result.size(), result.begin());
  return result;
}

// Understands the words of lights at infinity, for a LightVector and for a Scene.

// Fails if a word is wrong, or names a light that stands in the scene, which `refused` then says.
inline Expected<std::vector<spec::Light>> distantLights(const std::vector<std::string>& words,
                                                        const Failure& refused) {
  Result<std::vector<spec::Light>> lights = spec::parseLights(words);
  if (!lights) return failureOf(lights.error());
  if (!spec::localLights(*lights).empty()) return refused;
  return std::move(*lights);
}

}  // namespace lambent::library
