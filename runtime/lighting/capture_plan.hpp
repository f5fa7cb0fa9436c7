// Decides which bodies are drawn for which point, and where: the CPU's part of the light capture, without GL.
// Bodies smaller than a quarter of a texel are left out; the others are drawn at their coarsest level whose
// error is below half a texel. On each face of a point's cube, the bounding rectangles of the bodies, in
// whole texels, become tiles of an atlas, and overlapping rectangles become one tile. It takes the bounds of
// the proxies, bodies and points, and returns pages (one atlas each; all tiles of a point are on the same
// page), tiles and draws.
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

// Describes the texels [x0, x1) x [y0, y1) of a face.
struct TexelRect {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  std::uint32_t width() const { return x1 - x0; }
  std::uint32_t height() const { return y1 - y0; }
  bool operator==(const TexelRect&) const = default;
};

struct ProxyBounds {
  glm::vec3 lowest{0.0f}, highest{0.0f}, centre{0.0f};
  float radius_m = 0.0f;              // about the centre; a proxy with radius 0 is not drawn
  std::vector<float> level_errors_m;  // one per level, finest first

  static ProxyBounds of(const bundle::CaptureProxy& proxy);
};

struct Tile {
  std::uint32_t point = 0, face = 0;
  TexelRect texels;
  std::uint32_t x = 0, y = 0;  // the tile's first pixel in the page's atlas
};

struct Draw {
  std::uint32_t tile = 0, body = 0, level = 0;
  bool from_outside = false;  // the point lies outside the body's box
};

struct Page {
  std::uint32_t height = 0;  // rows of the atlas in use, in pixels; the whole width is in use
  std::uint32_t first_point = 0, point_count = 0;  // indices into Plan::points
  std::uint32_t first_draw = 0, draw_count = 0;
};

struct PlannedPoint {
  std::uint32_t point = 0;
  std::uint32_t first_tile = 0, tile_count = 0;
  float near_m = 0.0f;
};

struct Plan {
  std::vector<PlannedPoint> points;  // only points that see a body
  std::vector<Tile> tiles;
  std::vector<Draw> draws;
  std::vector<Page> pages;
};

// An atlas has this size in pixels. A page with a single point may be higher, below 8192.
inline constexpr std::uint32_t kAtlasWidth = 2048, kAtlasHeight = 4096;
// These limits keep a dispatch below the 65535 work groups that OpenGL guarantees.
inline constexpr std::uint32_t kMaxPointsOfPage = 65535, kMaxTexelsOfPage = 1u << 21;

// Holds a sphere around a body and the body's brightness, which suffice to tell whether a point sees it.
struct BodySphere {
  glm::dvec3 centre_ws{0.0};
  double radius_m = 0;  // 0: there is nothing to see
  double scale = 0;     // of the body relative to its proxy
  float brightness = 1.0f;

  static BodySphere of(const CaptureBody& body, const ProxyBounds& bounds);
};

// Returns whether the body is drawn at all for a point at this position.
bool sees(const CaptureOptions& options, const glm::vec3& position_ws, const BodySphere& body);

// Returns the matrix whose rows give the face coordinates (sc w, tc w, w) of a world direction; see
// sh::cubeFaceDirection.
const glm::dmat3& faceFromWorld(std::uint32_t face);
std::uint32_t faceOf(const glm::dvec3& direction);

// Returns the texels of a face in which the body may be visible, or nothing if it cannot be.
std::optional<TexelRect> faceRect(std::uint32_t size, std::uint32_t face, const CapturePoint& point,
                                  const CaptureBody& body, const ProxyBounds& bounds);

Plan plan(const CaptureOptions& options, std::span<const ProxyBounds> proxies,
          std::span<const CaptureBody> bodies, std::span<const CapturePoint> points);

}  // namespace lambent::lighting::capture
