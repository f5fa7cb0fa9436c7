// Makes small proxies for tests of the light capture, and measures its error.
#pragma once

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::testing {

inline bundle::CaptureProxy proxyOf(std::vector<glm::vec3> positions,
                                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                    bool front_only = false) {
  bundle::CaptureProxy proxy;
  proxy.positions = std::move(positions);
  for (const auto& vertices : triangles)
    proxy.triangles.push_back({.vertices = vertices, .front_only = front_only});
  proxy.levels = {{0, static_cast<std::uint32_t>(triangles.size()), 0.0f}};
  return proxy;
}

// Makes a square of 2 x 2 in the plane z = 0 that emits along +Z.
inline bundle::CaptureProxy squareProxy(bool front_only = false) {
  return proxyOf({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, front_only);
}

// Makes a polygon with the area of a disc of radius 1, in the plane z = 0, that emits along +Z.
inline bundle::CaptureProxy discProxy(std::uint32_t corners = 256) {
  const double turn = 2 * std::numbers::pi / corners;
  const double radius = std::sqrt(turn / std::sin(turn));
  bundle::CaptureProxy proxy;
  for (std::uint32_t i = 0; i < corners; ++i)
    proxy.positions.emplace_back(radius * std::cos(turn * i), radius * std::sin(turn * i), 0.0);
  for (std::uint32_t i = 1; i + 1 < corners; ++i) proxy.triangles.push_back({.vertices = {0, i, i + 1}});
  proxy.levels = {{0, corners - 2, 0.0f}};
  return proxy;
}

// Makes the cube [-1, 1]³, visible from outside or from inside.
inline bundle::CaptureProxy cubeProxy(bool inside = false) {
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 8; ++i) positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                                         {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                         {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  if (inside)
    for (auto& t : triangles) std::swap(t[1], t[2]);
  return proxyOf(std::move(positions), triangles);
}

// Returns a matrix that scales, turns +Z towards `to` and moves to `center`.
inline glm::mat4 facing(const glm::vec3& center, const glm::vec3& to, float scale) {
  const glm::vec3 z = glm::normalize(to - center);
  const glm::vec3 x =
      glm::normalize(glm::cross(std::abs(z.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), z));
  return glm::mat4(glm::vec4(scale * x, 0), glm::vec4(scale * glm::cross(z, x), 0), glm::vec4(scale * z, 0),
                   glm::vec4(center, 1));
}

// Makes a disc that has the given angular radius as seen from `from`.
inline lighting::CaptureBody discBody(std::uint32_t proxy, const glm::vec3& from, const glm::vec3& direction,
                                      double radius_rad, float distance_m) {
  return {.proxy = proxy,
          .world_from_proxy = facing(from + distance_m * direction, from,
                                     distance_m * static_cast<float>(std::tan(radius_rad)))};
}

// Returns |light - exact|² / |exact|².
inline double squaredError(const sh::LightVector& light, const sh::LightVector& exact) {
  double difference = 0, whole = 0;
  for (std::size_t i = 0; i < exact.c.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(light.c[i]) - glm::dvec3(exact.c[i]);
    difference += glm::dot(d, d);
    whole += glm::dot(glm::dvec3(exact.c[i]), glm::dvec3(exact.c[i]));
  }
  return difference / whole;
}

}  // namespace lambent::testing
