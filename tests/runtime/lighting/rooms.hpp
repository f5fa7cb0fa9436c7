// Builds rooms as capture proxies, with known answers.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::testing {

// Returns light without colour.
inline std::vector<glm::vec3> grey(const std::vector<float>& light) {
  std::vector<glm::vec3> all;
  for (const float value : light) all.emplace_back(value);
  return all;
}

// The proxy has one level, and every triangle reflects `albedo`.
class RoomBuilder {
 public:
  RoomBuilder() { proxy_.levels = {{.first_triangle = 0, .triangle_count = 0, .error_m = 0.0f}}; }

  RoomBuilder& triangle(const std::array<glm::vec3, 3>& corners, const glm::vec3& albedo) {
    const auto first = static_cast<std::uint32_t>(proxy_.positions.size());
    proxy_.positions.insert(proxy_.positions.end(), corners.begin(), corners.end());
    proxy_.triangles.push_back({.vertices = {first, first + 1, first + 2},
                                .front_only = false,
                                .first_entry = static_cast<std::uint32_t>(proxy_.entries.size()),
                                .entry_count = 1});
    proxy_.entries.push_back({.sample = 0, .reflectance = albedo});
    ++proxy_.levels[0].triangle_count;
    return *this;
  }
  // Adds a parallelogram, visible from the side on which its edges run counter-clockwise.
  RoomBuilder& wall(const glm::vec3& corner, const glm::vec3& right, const glm::vec3& up,
                    const glm::vec3& albedo) {
    triangle({corner, corner + right, corner + right + up}, albedo);
    return triangle({corner, corner + right + up, corner + up}, albedo);
  }
  // Adds a box that is visible from inside.
  RoomBuilder& box(const glm::vec3& low, const glm::vec3& high, const glm::vec3& albedo) {
    const glm::vec3 size = high - low;
    const glm::vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    wall(low, x, y, albedo);
    wall(low, y, z, albedo);
    wall(low, z, x, albedo);
    wall(high, -y, -x, albedo);
    wall(high, -z, -y, albedo);
    return wall(high, -x, -z, albedo);
  }
  // Adds a sphere of radius 1 about the origin that is visible from inside.
  RoomBuilder& sphere(int rings, int segments, const glm::vec3& albedo) {
    const auto at = [&](int ring, int segment) {
      const float down = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
      const float turn =
          2.0f * std::numbers::pi_v<float> * static_cast<float>(segment) / static_cast<float>(segments);
      return glm::vec3(std::sin(down) * std::cos(turn), std::cos(down), std::sin(down) * std::sin(turn));
    };
    for (int ring = 0; ring < rings; ++ring)
      for (int segment = 0; segment < segments; ++segment) {
        const glm::vec3 a = at(ring, segment), b = at(ring, segment + 1), c = at(ring + 1, segment + 1),
                        d = at(ring + 1, segment);
        if (ring > 0) inwards({a, b, c}, albedo);
        if (ring + 1 < rings) inwards({a, c, d}, albedo);
      }
    return *this;
  }
  bundle::CaptureProxy proxy() const { return proxy_; }
  bundle::PatchSurface surface() const { return bundle::patchSurfaceOf(proxy_); }

 private:
  void inwards(std::array<glm::vec3, 3> corners, const glm::vec3& albedo) {
    const glm::vec3 n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (glm::dot(n, corners[0]) > 0.0f) std::swap(corners[1], corners[2]);
    triangle(corners, albedo);
  }
  bundle::CaptureProxy proxy_;
};

}  // namespace lambent::testing
