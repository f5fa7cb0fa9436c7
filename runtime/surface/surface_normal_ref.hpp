// This is the CPU twin of surface_normal.glsl, with the same names and order of terms, so that a test can
// compare the two. Vectors are in the group's frame, texels linear in 0..1. No GL.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/transfer/transfer_ref.hpp"

namespace lambent::frame::ref {

struct TangentFrame {
  glm::vec3 normal, tangent;
  float handedness;
};

inline constexpr float kNoLength = 1e-36f;

inline glm::vec3 alongSurface(glm::vec3 normal, glm::vec3 direction) {
  const glm::vec3 part = direction - glm::dot(direction, normal) * normal;
  const float squared = glm::dot(part, part);
  return squared > kNoLength ? part / std::sqrt(squared) : glm::vec3(0.0f);
}

inline TangentFrame frameFromTangent(glm::vec3 normal, glm::vec4 tangent) {
  return {normal, alongSurface(normal, glm::vec3(tangent)), tangent.w < 0.0f ? -1.0f : 1.0f};
}

inline TangentFrame frameFromDerivatives(glm::vec3 normal, glm::vec3 p_dx, glm::vec3 p_dy, glm::vec2 t_dx,
                                         glm::vec2 t_dy) {
  const float area = t_dx.x * t_dy.y - t_dy.x * t_dx.y;
  const float turn = area > 0.0f ? 1.0f : area < 0.0f ? -1.0f : 0.0f;
  const glm::vec3 rising_u = turn * (t_dy.y * p_dx - t_dx.y * p_dy);
  const glm::vec3 rising_v = turn * (t_dx.x * p_dy - t_dy.x * p_dx);
  const glm::vec3 tangent = alongSurface(normal, rising_u);
  return {normal, tangent, glm::dot(glm::cross(normal, tangent), rising_v) > 0.0f ? -1.0f : 1.0f};
}

inline glm::vec3 perturbedNormal(const TangentFrame& frame, glm::vec3 texel, float scale) {
  const glm::vec3 bump = (2.0f * texel - 1.0f) * glm::vec3(scale, scale, 1.0f);
  if (frame.tangent == glm::vec3(0.0f) || glm::dot(bump, bump) <= kNoLength) return frame.normal;
  const glm::vec3 bitangent = frame.handedness * glm::cross(frame.normal, frame.tangent);
  return glm::normalize(bump.x * frame.tangent + bump.y * bitangent + bump.z * frame.normal);
}

using transfer::ref::diffuseLight;

}  // namespace lambent::frame::ref
