// Holds what a light capture keeps of a proxy: its bounds, and its levels in the form in which they are
// drawn. It is made once per proxy and from that proxy alone, so that it stays valid when other proxies come
// and go. No GL.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture_plan.hpp"

namespace lambent::lighting::capture {

// Tells whether a level of a proxy consists of closed surfaces that face outwards. Then only bright sides are
// visible from outside its box, and the dark sides need not be drawn. Levels with double-sided triangles
// never count as closed.
bool isClosed(const bundle::CaptureProxy& proxy, const bundle::ProxyLevel& level);

// A vertex is its position as bits of three floats, then its surface id: the triangle's number in its proxy +
// 1, kBlackId, or 0 for a vertex that is no triangle's last corner.
using Vertex = std::array<std::uint32_t, 4>;

struct LevelTriangle {
  // These are indices of vertices of the level. The last one carries the id of the surface seen from the
  // front: the triangle or black.
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t black = 0;  // the last corner seen from behind, whose id is kBlackId; unused if front_only
  bool front_only = false;
  glm::dvec4 plane{0.0};  // in the proxy's frame; positive on the bright side
};

struct PreparedLevel {
  std::uint32_t first_vertex = 0;  // index into PreparedProxy::vertices
  std::vector<LevelTriangle> triangles;
  bool closed = false;  // from outside no dark side is visible
};

struct PreparedProxy {
  ProxyBounds bounds;
  std::vector<PreparedLevel> levels;
  std::vector<Vertex> vertices;
  std::uint32_t triangle_count = 0;

  static PreparedProxy of(const bundle::CaptureProxy& proxy);
};

}  // namespace lambent::lighting::capture
