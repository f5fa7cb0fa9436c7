// Decides which bodies are drawn for which point, and where: the CPU's part of the light capture, without GL.
// Bodies smaller than a quarter of a texel are left out; the others are drawn at their coarsest level whose
// error is below half a texel. On each face of a point's cube, the bounding rectangles of the bodies, in
// whole texels, become tiles of an atlas, and overlapping rectangles become one tile. It takes the bounds of
// the proxies, bodies and points, and returns pages (one atlas each; all tiles of a point are on the same
// page), tiles and draws.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/capture_shared.h"
#include "runtime/sh/basis.hpp"

namespace lambent::lighting {

// These are the options of the light capture, the bodies that are drawn, the points with their queries, and
// the resulting light.

struct CaptureOptions {
  std::uint32_t size = 16;        // texels along an edge of a cube map, 4..64
  std::uint32_t subsamples = 16;  // along an edge of a texel, 1..16
  int order = 6;                  // number of bands of the resulting light
  bool operator==(const CaptureOptions&) const = default;
};

// Describes a body at its current place. `proxy` is an index into those given to setProxies().
struct CaptureBody {
  std::uint32_t proxy = 0;
  glm::mat4 world_from_proxy{1.0f};  // rotation, translation, uniform scale
  // Bodies smaller than a quarter of a texel are left out. The limit on their size falls in proportion for a
  // body that is this many times brighter than its surroundings.
  float brightness = 1.0f;
};

// Asks which share of an analytic light is visible from a point.
struct LightQuery {
  glm::vec3 direction{0.0f, 1.0f, 0.0f};  // unit vector towards the light, world axes
  float angular_radius_rad = 0.0f;        // 0 asks for a single direction
  float distance_m = 0.0f;                // bodies beyond this distance do not hide it; 0: at infinity
};

struct CapturePoint {
  static constexpr std::uint32_t kNoBody = 0xffffffffu;
  glm::vec3 position_ws{0.0f};
  std::uint32_t own_body = kNoBody;  // index of the body that the point belongs to and does not see
  std::vector<LightQuery> queries{};
  std::vector<std::uint32_t> left_out{};  // other bodies that it does not see

  bool ignores(std::uint32_t body) const {
    return body == own_body || std::find(left_out.begin(), left_out.end(), body) != left_out.end();
  }
};

struct CapturedLight {
  sh::LightVector light;        // in world axes: the sky without its discs, and bodies
  glm::vec3 sky_visible{1.0f};  // share of the sky's light that no body hides, per channel
  std::vector<float> visible;   // for each query, 0..1
};

namespace capture {

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

Plan plan(const CaptureOptions& options, std::span<const ProxyBounds> proxies,
          std::span<const CaptureBody> bodies, std::span<const CapturePoint> points);

// Measures how much of a light's disc bodies hide. Directions spread over the disc are looked up in the drawn
// cube maps. appendLookups() turns a query and the tiles of its point into pixels and depths for the GPU;
// visibleShare() turns the bits that come back into the visible share. No GL.

// A surface does not hide the light if it is as far away as the light, within this relative tolerance.
inline constexpr double kSameDistance = 1e-3;

// Describes a lookup for the GPU. Bit i of a result word tells whether something is nearer than the light
// along direction i.
struct Lookup {
  std::uint32_t pixel = kNoPixel;  // x | y << 16
  std::uint32_t depth_bits = 0;    // bits of a float: near / w, so larger values are nearer
};

// Returns unit directions that each represent the same solid angle of the disc. Radius 0 gives one direction.
std::vector<glm::vec3> discDirections(const LightQuery& query);

// Appends kLookupsPerWord entries for each of the point's queries.
void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups);

// Returns the visible share, 0..1.
float visibleShare(const LightQuery& query, std::uint32_t hidden_bits);

// Turns the sums that the GPU made over a point's tiles into the light at that point. Texels without a tile
// see all of the sky, so the light is
//   bodies + (projection of the whole sky's texels - sky that bodies hide)
//   + v ∘ (exact sky - projection of the whole sky's texels)
// where v is the visible share of the sky's light. The last term corrects the error that the texels make in
// the sky: with nothing in front the exact light results, and behind a closed wall nothing of it is left.

// Fills light and sky_visible of `out`. `sums` holds order² pairs as capture_project.comp writes them;
// `uncovered` is the number of the cube's texels without a tile.
inline void combine(std::span<const glm::vec4> sums, std::uint32_t uncovered, const sh::LightVector& exact,
                    const sh::LightVector& through_texels, CapturedLight& out) {
  out.light = sh::LightVector{.order = exact.order};
  const std::span<glm::vec3> light = out.light.coefficients();
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = glm::vec3(sums[2 * i]);
  // Nothing of the sky is visible. The general formula would subtract two large numbers here, and the
  // rounding errors of a bright sky would shine into closed rooms.
  if (uncovered == 0 && sums[0].w == 0.0f) {
    out.sky_visible = glm::vec3(0.0f);
    return;
  }
  // w_0 = Omega y_00, so these are sums over solid angle. For a channel in which the sky is black, the share
  // is that of the solid angle alone.
  const glm::vec4& hidden = sums[1];
  const float hidden_share = hidden.w / (2 * std::sqrt(std::numbers::pi_v<float>));
  for (int channel = 0; channel < 3; ++channel) {
    const float all = through_texels.c[0][channel];
    const float share = all > 0 ? hidden[channel] / all : hidden_share;
    out.sky_visible[channel] = glm::clamp(1.0f - share, 0.0f, 1.0f);
  }
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] += (through_texels.c[i] - glm::vec3(sums[2 * i + 1])) +
                out.sky_visible * (exact.c[i] - through_texels.c[i]);
}

}  // namespace capture

}  // namespace lambent::lighting
