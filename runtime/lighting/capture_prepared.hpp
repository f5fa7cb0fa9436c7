// What a light capture keeps of a proxy: its levels as they are drawn, and its bounds. Made once for each
// proxy, when it comes, from the proxy alone, so that it stays as it is when others come and go. No GL.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture_plan.hpp"

namespace lambent::lighting::capture {

// Position as bits of floats, surface id: 0 of a vertex that no triangle ends in, kBlackId, or else the
// triangle's number in its proxy + 1.
using Vertex = std::array<std::uint32_t, 4>;

struct LevelTriangle {
  // Vertices of the level. The last one names the surface: that of the bright side, or black.
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t black = 0;  // of a triangle that is there from behind: its last corner, black
  bool front_only = false;
  glm::dvec4 plane{0.0};  // proxy frame; over 0 on the bright side
};

struct PreparedLevel {
  std::uint32_t first_vertex = 0;  // of the proxy's
  std::vector<LevelTriangle> triangles;
  bool closed = false;  // seen from outside, no dark side can show
};

struct PreparedProxy {
  ProxyBounds bounds;
  std::vector<PreparedLevel> levels;
  std::vector<Vertex> vertices;
  std::uint32_t triangle_count = 0;

  static PreparedProxy of(const bundle::CaptureProxy& proxy);
};

}  // namespace lambent::lighting::capture
