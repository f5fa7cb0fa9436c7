// Converts between the values that the library shows and those of the rooms.
#pragma once

#include <utility>

#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "lambent/math.hpp"
#include "lambent/result.hpp"
#include "runtime/base/result.hpp"

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

}  // namespace lambent::library
