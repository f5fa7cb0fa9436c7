#include "runtime/lighting/capture_plan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::lighting::capture {

namespace {

constexpr double kCullShare = 0.25;       // share of a texel's solid angle below which bodies are left out
constexpr double kLevelErrorShare = 0.5;  // of a texel's width; levels keep solid angles, if not outlines
// These give the near plane as a share of the distance to the nearest body's box, or of the radius of a body
// that contains the point. Reversed depth keeps its precision.
constexpr double kLocalShare = 1e-3, kLeastLocalShare = 1e-9;
// Rectangles grow by this share of a texel, so that rounding cannot cut a body's edge.
constexpr double kRectMargin = 1e-4;

struct Sphere {
  glm::dvec3 centre{0.0};  // relative to the point
  double radius_m = 0;     // 0: there is nothing to see
  double scale = 0;
};

Sphere seenFrom(const glm::vec3& position_ws, const BodySphere& body) {
  return {.centre = body.centre_ws - glm::dvec3(position_ws), .radius_m = body.radius_m, .scale = body.scale};
}

bool largeEnough(const CaptureOptions& options, const glm::dvec3& centre, double radius_m, float brightness) {
  const double squared = glm::dot(centre, centre), radius_squared = radius_m * radius_m;
  if (!(radius_m > 0) || !std::isfinite(radius_m + squared)) return false;
  if (squared <= radius_squared) return true;
  // The solid angle, 2 pi (1 - cos a), is between pi sin² a and twice that, which mostly decides. A texel's
  // solid angle is 4 pi over the number of texels. Both sides are multiplied by that number and `squared`,
  // and divided by pi.
  const double brighter = brightness > 1.0f ? static_cast<double>(brightness) : 1.0;
  const double texels = 6.0 * options.size * options.size;
  const double least = texels * radius_squared * brighter, needed = 4 * kCullShare * squared;
  constexpr double kClearly = 1 + 1e-9;
  if (2 * least * kClearly < needed) return false;
  if (least > needed * kClearly) return true;
  // This form keeps its digits for small a.
  const double sine_squared = radius_squared / squared;
  return 2 * least >= needed * (1 + std::sqrt(std::max(0.0, 1 - sine_squared)));
}

std::uint32_t levelFor(const CaptureOptions& options, const Sphere& sphere, const ProxyBounds& bounds) {
  const double distance_m = glm::length(sphere.centre) - sphere.radius_m;
  if (!(distance_m > 0)) return 0;
  const double texel_rad = 0.5 * std::numbers::pi / options.size;
  std::uint32_t level = 0;
  for (std::uint32_t i = 0; i < bounds.level_errors_m.size(); ++i)
    if (static_cast<double>(bounds.level_errors_m[i]) * sphere.scale <=
        kLevelErrorShare * texel_rad * distance_m)
      level = i;
  return level;
}

using Corners = std::array<glm::dvec3, 8>;

Corners cornersOf(const CaptureBody& body, const ProxyBounds& bounds) {
  const glm::dmat4 m(body.world_from_proxy);
  Corners corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec4 at((i & 1 ? bounds.highest : bounds.lowest).x,
                        (i & 2 ? bounds.highest : bounds.lowest).y,
                        (i & 4 ? bounds.highest : bounds.lowest).z, 1.0);
    corners[i] = glm::dvec3(m * at);
  }
  return corners;
}

Corners seenFrom(const glm::vec3& position_ws, Corners corners) {
  for (glm::dvec3& corner : corners) corner -= glm::dvec3(position_ws);
  return corners;
}

// Returns the distance from the point to the box, 0 inside.
double boxDistance(const Corners& corners) {
  glm::dvec3 nearest = corners[0];
  for (const std::size_t k : {1u, 2u, 4u}) {
    const glm::dvec3 edge = corners[k] - corners[0];
    const double squared = glm::dot(edge, edge);
    if (squared > 0) nearest += std::clamp(-glm::dot(corners[0], edge) / squared, 0.0, 1.0) * edge;
  }
  return glm::length(nearest);
}

struct Interval {
  double lowest = -1, highest = 1;  // range of sc or tc
};

// Returns the tangents of the directions under which a circle of radius r about (x, w) is seen.
Interval circleInterval(double x, double w, double r) {
  const double distance = std::hypot(x, w);
  if (distance <= r) return {};
  const double middle = std::atan2(x, w), half = std::asin(r / distance), end = std::numbers::pi / 4;
  if (middle - half >= end || middle + half <= -end) return {1, -1};
  return {middle - half > -end ? std::tan(middle - half) : -1,
          middle + half < end ? std::tan(middle + half) : 1};
}

std::optional<TexelRect> rectOf(std::uint32_t size, std::uint32_t face, const Sphere& sphere,
                                const Corners& corners) {
  const glm::dmat3& from_world = faceFromWorld(face);
  const glm::dvec3 c = from_world * sphere.centre;
  // The sphere lies wholly behind the point or behind one of the planes through it that bound the face.
  const double beyond = std::numbers::sqrt2 * sphere.radius_m * (1 + 1e-9);
  if (c.z <= -sphere.radius_m || std::abs(c.x) - c.z > beyond || std::abs(c.y) - c.z > beyond)
    return std::nullopt;
  Interval sc = circleInterval(c.x, c.z, sphere.radius_m), tc = circleInterval(c.y, c.z, sphere.radius_m);

  // The body's box is cut off just in front of the point; its projection is the hull of its corners.
  const double cut = 1e-6 * sphere.radius_m;
  Corners at;
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = from_world * corners[i];
  Interval box_sc{1e30, -1e30}, box_tc{1e30, -1e30};
  const auto include = [&](const glm::dvec3& p, double w) {
    box_sc = {std::min(box_sc.lowest, p.x / w), std::max(box_sc.highest, p.x / w)};
    box_tc = {std::min(box_tc.lowest, p.y / w), std::max(box_tc.highest, p.y / w)};
  };
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i].z >= cut) include(at[i], at[i].z);
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const std::size_t other = i | bit;
      if (other == i || (at[i].z >= cut) == (at[other].z >= cut)) continue;
      const double t = (cut - at[i].z) / (at[other].z - at[i].z);
      include(at[i] + t * (at[other] - at[i]), cut);
    }
  }
  sc = {std::max(sc.lowest, box_sc.lowest), std::min(sc.highest, box_sc.highest)};
  tc = {std::max(tc.lowest, box_tc.lowest), std::min(tc.highest, box_tc.highest)};
  if (sc.lowest > sc.highest || tc.lowest > tc.highest) return std::nullopt;
  const auto first = [&](double s) {
    return static_cast<std::uint32_t>(
        std::clamp(std::floor((s + 1) / 2 * size - kRectMargin), 0.0, double(size)));
  };
  const auto last = [&](double s) {
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil((s + 1) / 2 * size + kRectMargin), 0.0, double(size)));
  };
  const TexelRect rect{first(sc.lowest), first(tc.lowest), last(sc.highest), last(tc.highest)};
  if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1) return std::nullopt;
  return rect;
}

bool overlap(const TexelRect& a, const TexelRect& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

TexelRect together(const TexelRect& a, const TexelRect& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// Makes the rectangles disjoint by merging those that overlap.
void mergeOverlaps(std::vector<TexelRect>& rects) {
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < rects.size(); ++i)
      for (std::size_t j = i + 1; j < rects.size();) {
        if (!overlap(rects[i], rects[j])) {
          ++j;
          continue;
        }
        rects[i] = together(rects[i], rects[j]);
        rects[j] = rects.back();
        rects.pop_back();
        merged = true;
      }
  }
}

// Appends the tiles and draws of one point to the plan.
class PointPlanner {
 public:
  PointPlanner(const CaptureOptions& options, std::span<const ProxyBounds> proxies,
               std::span<const CaptureBody> bodies, Plan& plan)
      : options_(options), proxies_(proxies), bodies_(bodies), plan_(plan) {
    for (const CaptureBody& body : bodies) {
      const bool known = body.proxy < proxies.size();
      spheres_.push_back(known ? BodySphere::of(body, proxies[body.proxy]) : BodySphere{});
      corners_.push_back(known ? cornersOf(body, proxies[body.proxy]) : Corners{});
    }
  }

  void add(std::uint32_t index, const CapturePoint& point) {
    if (!isFinite(point.position_ws)) return;
    seen_.clear();
    double near_m = std::numeric_limits<double>::max();
    for (std::uint32_t b = 0; b < bodies_.size(); ++b) {
      if (!sees(options_, point.position_ws, spheres_[b]) || point.ignores(b)) continue;
      const ProxyBounds& bounds = proxies_[bodies_[b].proxy];
      const Sphere sphere = seenFrom(point.position_ws, spheres_[b]);
      const Corners corners = seenFrom(point.position_ws, corners_[b]);
      const double distance_m = boxDistance(corners);
      seen_.push_back({b, levelFor(options_, sphere, bounds), sphere, corners});
      near_m = std::min(near_m, std::max(kLocalShare * distance_m, kLeastLocalShare * sphere.radius_m));
    }
    const auto first_tile = static_cast<std::uint32_t>(plan_.tiles.size());
    for (std::uint32_t face = 0; face < 6; ++face) addFace(index, face);
    const auto tile_count = static_cast<std::uint32_t>(plan_.tiles.size()) - first_tile;
    if (tile_count > 0)
      plan_.points.push_back({index, first_tile, tile_count,
                              std::max(static_cast<float>(near_m), std::numeric_limits<float>::min())});
  }

 private:
  struct Seen {
    std::uint32_t body, level;
    Sphere sphere;
    Corners corners;
  };

  void addFace(std::uint32_t index, std::uint32_t face) {
    on_face_.clear();
    rects_.clear();
    for (const Seen& seen : seen_)
      if (const auto rect = rectOf(options_.size, face, seen.sphere, seen.corners)) {
        on_face_.push_back({&seen, *rect});
        rects_.push_back(*rect);
      }
    mergeOverlaps(rects_);
    for (const TexelRect& rect : rects_) {
      const auto tile = static_cast<std::uint32_t>(plan_.tiles.size());
      plan_.tiles.push_back({.point = index, .face = face, .texels = rect});
      for (const auto& [seen, own] : on_face_)
        if (overlap(own, rect)) plan_.draws.push_back({tile, seen->body, seen->level});
    }
  }

  const CaptureOptions& options_;
  std::span<const ProxyBounds> proxies_;
  std::span<const CaptureBody> bodies_;
  Plan& plan_;
  std::vector<BodySphere> spheres_;  // indexed by body
  std::vector<Corners> corners_;     // indexed by body, world space
  std::vector<Seen> seen_;
  std::vector<std::pair<const Seen*, TexelRect>> on_face_;
  std::vector<TexelRect> rects_;
};

// Puts as many points on each page as fit. Tiles stand in rows, the highest of each point first.
void makePages(Plan& plan, std::uint32_t subsamples) {
  std::uint32_t x = 0, row = 0, next_row = 0, texels = 0, draw = 0;
  std::vector<Tile*> tiles;
  for (std::uint32_t p = 0; p < plan.points.size(); ++p) {
    const PlannedPoint& point = plan.points[p];
    const std::uint32_t end_tile = point.first_tile + point.tile_count;
    tiles.clear();
    std::uint32_t own_texels = 0;
    for (std::uint32_t t = point.first_tile; t < end_tile; ++t) {
      tiles.push_back(&plan.tiles[t]);
      own_texels += tiles.back()->texels.width() * tiles.back()->texels.height();
    }
    std::ranges::stable_sort(tiles, std::ranges::greater(),
                             [](const Tile* tile) { return tile->texels.height(); });
    const auto place = [&] {
      for (Tile* tile : tiles) {
        const std::uint32_t width = tile->texels.width() * subsamples;
        if (x + width > kAtlasWidth) {
          x = 0;
          row = next_row;
        }
        tile->x = x;
        tile->y = row;
        x += width;
        next_row = std::max(next_row, row + tile->texels.height() * subsamples);
      }
      return next_row <= kAtlasHeight;
    };
    const bool room = !plan.pages.empty() && plan.pages.back().point_count < kMaxPointsOfPage &&
                      texels + own_texels <= kMaxTexelsOfPage;
    if (!room || !place()) {
      plan.pages.push_back({.first_point = p, .first_draw = draw});
      x = row = next_row = texels = 0;
      place();  // a point alone on a page may need up to twice its area and a row: 7168 pixels
    }
    Page& page = plan.pages.back();
    page.height = next_row;
    ++page.point_count;
    texels += own_texels;
    while (draw < plan.draws.size() && plan.draws[draw].tile < end_tile) ++draw;
    page.draw_count = draw - page.first_draw;
  }
}

}  // namespace

ProxyBounds ProxyBounds::of(const bundle::CaptureProxy& proxy) {
  ProxyBounds bounds;
  for (const bundle::ProxyLevel& level : proxy.levels) bounds.level_errors_m.push_back(level.error_m);
  constexpr float kFar = std::numeric_limits<float>::max();
  glm::vec3 lowest(kFar), highest(-kFar);
  bool any = false;
  for (const bundle::ProxyTriangle& triangle : proxy.triangles)
    for (const std::uint32_t v : triangle.vertices) {
      if (!isFinite(proxy.positions[v])) continue;
      lowest = glm::min(lowest, proxy.positions[v]);
      highest = glm::max(highest, proxy.positions[v]);
      any = true;
    }
  if (!any || proxy.levels.empty()) return bounds;
  bounds.lowest = lowest;
  bounds.highest = highest;
  bounds.centre = 0.5f * lowest + 0.5f * highest;
  double squared = 0;
  for (const bundle::ProxyTriangle& triangle : proxy.triangles)
    for (const std::uint32_t v : triangle.vertices) {
      if (!isFinite(proxy.positions[v])) continue;
      const glm::dvec3 d = glm::dvec3(proxy.positions[v]) - glm::dvec3(bounds.centre);
      squared = std::max(squared, glm::dot(d, d));
    }
  // The radius is a little larger than the farthest corner's distance, so that rounding cannot put that
  // outside.
  bounds.radius_m = static_cast<float>(std::sqrt(squared) * (1 + 1e-6));
  return bounds;
}

BodySphere BodySphere::of(const CaptureBody& body, const ProxyBounds& bounds) {
  const glm::dmat4 m(body.world_from_proxy);
  double squared = 0;
  for (int column = 0; column < 3; ++column)
    squared = std::max(squared, glm::dot(glm::dvec3(m[column]), glm::dvec3(m[column])));
  const double scale = std::sqrt(squared);
  return {.centre_ws = glm::dvec3(m * glm::dvec4(bounds.centre, 1.0)),
          .radius_m = scale * static_cast<double>(bounds.radius_m),
          .scale = scale,
          .brightness = body.brightness};
}

bool sees(const CaptureOptions& options, const glm::vec3& position_ws, const BodySphere& body) {
  return largeEnough(options, body.centre_ws - glm::dvec3(position_ws), body.radius_m, body.brightness);
}

const glm::dmat3& faceFromWorld(std::uint32_t face) {
  static const std::array<glm::dmat3, 6> kFaces = [] {
    std::array<glm::dmat3, 6> faces;
    for (int f = 0; f < 6; ++f) {
      const glm::dvec3 forward = sh::cubeFaceDirection(f, 0, 0);
      faces[static_cast<std::size_t>(f)] = glm::transpose(glm::dmat3(
          sh::cubeFaceDirection(f, 1, 0) - forward, sh::cubeFaceDirection(f, 0, 1) - forward, forward));
    }
    return faces;
  }();
  return kFaces[face];
}

std::uint32_t faceOf(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  if (size.x >= size.y && size.x >= size.z) return direction.x >= 0 ? 0 : 1;
  if (size.y >= size.z) return direction.y >= 0 ? 2 : 3;
  return direction.z >= 0 ? 4 : 5;
}

Plan plan(const CaptureOptions& options, std::span<const ProxyBounds> proxies,
          std::span<const CaptureBody> bodies, std::span<const CapturePoint> points) {
  Plan plan;
  PointPlanner planner(options, proxies, bodies, plan);
  for (std::uint32_t i = 0; i < points.size(); ++i) planner.add(i, points[i]);
  makePages(plan, options.subsamples);
  return plan;
}

namespace {

bool usable(const glm::dvec3& direction) {
  const double squared = glm::dot(direction, direction);
  return std::isfinite(squared) && squared > 0;
}

}  // namespace

std::vector<glm::vec3> discDirections(const LightQuery& query) {
  const glm::dvec3 given(query.direction);
  if (!usable(given)) return {};
  const glm::dvec3 axis = glm::normalize(given);
  const double radius = static_cast<double>(query.angular_radius_rad);
  if (!(radius > 0)) return {glm::vec3(axis)};
  const double height = 1 - std::cos(std::min(radius, std::numbers::pi));  // of the spherical cap
  // This frame has no branches at the poles (Duff et al. 2017).
  const double sign = std::copysign(1.0, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  const glm::dvec3 u(1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
      v(b, sign + axis.y * axis.y * a, -axis.y);
  std::vector<glm::vec3> directions;
  directions.reserve(kLookupsPerWord);
  for (std::uint32_t k = 0; k < kLookupsPerWord; ++k) {
    // Vogel's spiral takes equal steps of solid angle outwards and turns by the golden angle.
    const double down = height * (k + 0.5) / kLookupsPerWord;
    const double sine = std::sqrt(std::max(0.0, down * (2 - down)));
    const double turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
    directions.emplace_back((1 - down) * axis + sine * (std::cos(turn) * u + std::sin(turn) * v));
  }
  return directions;
}

void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups) {
  for (const LightQuery& query : point.queries) {
    const std::size_t first = lookups.size();
    lookups.resize(first + kLookupsPerWord);
    std::size_t k = first;
    for (const glm::vec3& direction : discDirections(query)) {
      Lookup& lookup = lookups[k++];
      const std::uint32_t face = faceOf(direction);
      const glm::dvec3 at = faceFromWorld(face) * glm::dvec3(direction);
      const auto pixelOf = [&](double s) {
        const double pixels = static_cast<double>(size) * subsamples;
        return static_cast<std::uint32_t>(std::clamp((s + 1) / 2 * pixels, 0.0, pixels - 1));
      };
      const std::uint32_t x = pixelOf(at.x / at.z), y = pixelOf(at.y / at.z);
      for (const Tile& tile : tiles.subspan(planned.first_tile, planned.tile_count)) {
        const TexelRect& r = tile.texels;
        if (tile.face != face || x < r.x0 * subsamples || x >= r.x1 * subsamples || y < r.y0 * subsamples ||
            y >= r.y1 * subsamples)
          continue;
        lookup.pixel = (tile.x + x - r.x0 * subsamples) | (tile.y + y - r.y0 * subsamples) << 16;
        const double w = static_cast<double>(query.distance_m) * at.z;
        const double depth =
            w > 0 ? std::min(static_cast<double>(planned.near_m) / w * (1 + kSameDistance), 2.0) : 0.0;
        lookup.depth_bits = std::bit_cast<std::uint32_t>(static_cast<float>(depth));
        break;
      }
    }
  }
}

float visibleShare(const LightQuery& query, std::uint32_t hidden_bits) {
  const auto hidden = static_cast<double>(std::popcount(hidden_bits));
  if (hidden == 0.0) return 1.0f;  // also where a query has no directions
  return static_cast<float>(1 - hidden / static_cast<double>(discDirections(query).size()));
}

}  // namespace lambent::lighting::capture
