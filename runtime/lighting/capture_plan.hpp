// Which bodies are drawn for which point, where: the CPU's part of the light capture, without GL. Bodies
// under a quarter of a texel are left out, the others drawn by their coarsest level whose error is under half
// a texel. On each face of a point's cube the bodies' bounding rectangles, in whole texels, become
// tiles of an atlas; those that overlap are one tile. Comes in: bounds of the proxies, bodies, points. Goes
// out: pages (one atlas each, all tiles of a point on the same), tiles, draws.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture_scene.hpp"

namespace lambent::lighting::capture {

// Texels [x0, x1) x [y0, y1) of a face.
struct TexelRect {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::uint32_t width() const { return x1 - x0; }
  std::uint32_t height() const { return y1 - y0; }
  bool operator==(const TexelRect&) const = default;
};

struct ProxyBounds {
  glm::vec3 lowest{0.0f}, highest{0.0f}, centre{0.0f};
  float radius_m = 0.0f;              // about the centre; 0: draws nothing
  std::vector<float> level_errors_m;  // finest first

  static ProxyBounds of(const bundle::CaptureProxy& proxy);
};

struct Tile {
  std::uint32_t point = 0, face = 0;
  TexelRect texels;
  std::uint32_t x = 0, y = 0;  // its first pixel in the page's atlas
};

struct Draw {
  std::uint32_t tile = 0, body = 0, level = 0;
  bool from_outside = false;  // the point lies outside the body's box
};

struct Page {
  std::uint32_t height = 0;                        // pixels of the atlas that are in use; all of its width
  std::uint32_t first_point = 0, point_count = 0;  // into Plan::points
  std::uint32_t first_draw = 0, draw_count = 0;
};

struct PlannedPoint {
  std::uint32_t point = 0;
  std::uint32_t first_tile = 0, tile_count = 0;
  float near_m = 0.0f;
};

struct Plan {
  std::vector<PlannedPoint> points;  // only those that see a body
  std::vector<Tile> tiles;
  std::vector<Draw> draws;
  std::vector<Page> pages;
};

// Pixels. A page of one point may be higher, below 8192.
inline constexpr std::uint32_t kAtlasWidth = 2048, kAtlasHeight = 4096;
// So that a dispatch stays below the 65535 work groups that OpenGL promises.
inline constexpr std::uint32_t kMaxPointsOfPage = 65535, kMaxTexelsOfPage = 1u << 21;

// A sphere around a body, and how bright it is: enough to tell whether a point sees it.
struct BodySphere {
  glm::dvec3 centre_ws{0.0};
  double radius_m = 0;  // 0: there is nothing to see
  double scale = 0;     // of the body against its proxy
  float brightness = 1.0f;

  static BodySphere of(const CaptureBody& body, const ProxyBounds& bounds);
};

// Whether the body is drawn at all for a point.
bool sees(const CaptureOptions& options, const glm::vec3& position_ws, const BodySphere& body);

// Rows: face coordinates (sc w, tc w, w) of world directions; see sh::cubeFaceDirection.
const glm::dmat3& faceFromWorld(std::uint32_t face);
std::uint32_t faceOf(const glm::dvec3& direction);

// The texels of a face in which the body can be seen; none if it cannot.
std::optional<TexelRect> faceRect(std::uint32_t size, std::uint32_t face, const CapturePoint& point,
                                  const CaptureBody& body, const ProxyBounds& bounds);

Plan plan(const CaptureOptions& options, std::span<const ProxyBounds> proxies,
          std::span<const CaptureBody> bodies, std::span<const CapturePoint> points);

}  // namespace lambent::lighting::capture
