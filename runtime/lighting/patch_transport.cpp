#include "runtime/lighting/patch_transport.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "runtime/base/threads.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

// These lengths are relative to the extent of the patches.
constexpr float kLift = 2e-4f;
constexpr float kLeastThickness = 2e-3f;
constexpr float kOnPlane = 1e-5f;

constexpr float kSameWay = 0.5f;  // least cosine between normals of surfaces that face the same way

// These are the barycentric coordinates of the centres of the four parts of a triangle whose edges are
// halved.
constexpr std::array<glm::vec3, kPatchPoints> kPointWeights = {
    glm::vec3(1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f), glm::vec3(2.0f / 3.0f, 1.0f / 6.0f, 1.0f / 6.0f),
    glm::vec3(1.0f / 6.0f, 2.0f / 3.0f, 1.0f / 6.0f), glm::vec3(1.0f / 6.0f, 1.0f / 6.0f, 2.0f / 3.0f)};

// Returns into how many parts an edge is cut. Areas are weighed by the patches that they deserve.
std::uint32_t partsFor(float area, float wanted) {
  return wanted > 0.0f ? std::max(1u, static_cast<std::uint32_t>(std::lround(std::sqrt(area / wanted)))) : 1u;
}

}  // namespace

TrianglePart TrianglePart::at(std::uint32_t parts, float b, float c) {
  const float x = std::max(b, 0.0f) * static_cast<float>(parts);
  const float y = std::max(c, 0.0f) * static_cast<float>(parts);
  const auto row = std::min(static_cast<std::uint32_t>(y), parts - 1);
  const auto column = std::min(static_cast<std::uint32_t>(x), parts - 1 - row);
  const bool has_upper = column + row < parts - 1;
  const bool upper = has_upper && (x - static_cast<float>(column)) + (y - static_cast<float>(row)) > 1.0f;
  return {.column = column, .row = row, .upper = upper};
}

Patches::Patches(const bundle::PatchSurface& surface, std::size_t most) {
  if (surface.triangles.empty()) return;
  std::vector<RayTriangle> triangles;
  std::vector<float> areas, weighed;
  float whole = 0.0f;
  bool any_detail = false;
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const bundle::PatchTriangle& triangle : surface.triangles) {
    std::array<glm::vec3, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = surface.positions[triangle.vertices[k]];
      low = glm::min(low, corners[k]);
      high = glm::max(high, corners[k]);
    }
    const glm::vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const float length = glm::length(across);
    normals_.push_back(length > 0.0f ? across / length : glm::vec3(0.0f, 1.0f, 0.0f));
    areas.push_back(0.5f * length);
    weighed.push_back(areas.back() * bundle::patchDensity(triangle.detail));
    whole += weighed.back();
    any_detail |= triangle.detail > 0;
    triangles.push_back({.corners = corners, .front_only = triangle.front_only});
  }
  extent_ = glm::distance(low, high);
  // The bake knows the extent of what is seen, which may be small beside the bounds, and its error is at
  // least a share of it.
  if (any_detail) extent_ = std::min(extent_, surface.error_m / kLeastThickness);
  error_ = std::max(surface.error_m, kLeastThickness * extent_);
  tree_ = TriangleTree(std::move(triangles), kOnPlane * extent_);
  // Rounding gives some triangles more parts than their share; then all get a little fewer.
  float wanted = whole / static_cast<float>(std::max<std::size_t>(most, 1));
  for (int tries = 0; tries < 32; ++tries) {
    std::size_t count = 0;
    for (const float area : weighed) count += std::size_t{partsFor(area, wanted)} * partsFor(area, wanted);
    if (count <= most) break;
    wanted *= 1.1f;
  }
  for (std::size_t t = 0; t < tree_.size(); ++t) {
    const std::uint32_t parts = partsFor(weighed[t], wanted);
    levels_.push_back({Level{.parts = parts, .first = patches_.size()}});
    const auto& [a, b, c] = tree_[t].corners;
    const auto cornerAt = [&](std::uint32_t column, std::uint32_t row) {
      const glm::vec2 at = glm::vec2(column, row) / static_cast<float>(parts);
      return a + at.x * (b - a) + at.y * (c - a);
    };
    for (std::uint32_t row = 0; row < parts; ++row)
      for (std::uint32_t place = 0; place < 2 * (parts - row) - 1; ++place) {
        const std::uint32_t i = place / 2;
        const bool upper = place % 2 != 0;
        const glm::vec3 p = upper ? cornerAt(i + 1, row + 1) : cornerAt(i, row);
        const glm::vec3 q = cornerAt(i + 1, row), r = cornerAt(i, row + 1);
        Patch& patch = patches_.emplace_back();
        for (std::size_t k = 0; k < kPatchPoints; ++k)
          patch.points[k] = kPointWeights[k].x * p + kPointWeights[k].y * q + kPointWeights[k].z * r;
        patch.normal = normals_[t];
        patch.area = areas[t] / static_cast<float>(parts * parts);
        patch.albedo = surface.triangles[t].albedo;
      }
  }
  for (Patch& patch : patches_)
    for (std::size_t k = 0; k < kPatchPoints; ++k) patch.origins[k] = inFront(patch.points[k], patch.normal);
  findRegions();
}

float Patches::beside(std::size_t triangle, const glm::vec3& point) const {
  float outside = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3& corner = tree_[triangle].corners[k];
    const glm::vec3 inwards = glm::cross(normals_[triangle], tree_[triangle].corners[(k + 1) % 3] - corner);
    const float length = glm::length(inwards);
    if (length > 0.0f) outside = std::max(outside, -glm::dot(inwards, point - corner) / length);
  }
  return outside;
}

glm::vec3 Patches::inFront(glm::vec3 point, const glm::vec3& normal) const {
  const float lift = kLift * extent_;
  point += lift * normal;
  std::vector<std::uint32_t> around;
  tree_.findNear(point, 2.0f * (error_ + lift), around);
  const auto heightOver = [&](std::uint32_t t) { return glm::dot(normals_[t], point - tree_[t].corners[0]); };
  // The patches' error is that of their worst place. Here they are as far away as the nearest of them that
  // faces the same way. If the point lies farther behind another, that is the other side of something thin,
  // or another body.
  float here = error_;
  for (const std::uint32_t t : around)
    if (glm::dot(normals_[t], normal) > kSameWay)
      here = std::min(here, std::max(std::abs(heightOver(t)), beside(t, point)));
  here = std::max(here, kLeastThickness * extent_);
  for (const std::uint32_t t : around) {
    const float height = heightOver(t);
    if (height > 0.5f * lift || height < -here || glm::dot(normals_[t], normal) < -0.5f ||
        beside(t, point) > here)
      continue;
    // The point must not move through to the other side of something thin that it is in front of.
    const auto inTheWay = [&](std::uint32_t other) {
      if (glm::dot(normals_[other], normals_[t]) > -0.9f) return false;
      const float above = heightOver(other);
      return above >= 0.0f && above <= lift - height && beside(other, point) <= here;
    };
    if (std::ranges::none_of(around, inTheWay)) point += (lift - height) * normals_[t];
  }
  return point;
}

void Patches::findRegions() {
  for (std::vector<Level>& levels : levels_) {
    const auto [parts, first_patch] = levels[0];
    for (std::uint32_t coarse = parts; coarse > 1;) {
      coarse = (coarse + 1) / 2;
      levels.push_back({.parts = coarse, .first = regionCount()});
      members_.resize(members_.size() + std::size_t{coarse} * coarse);
      const std::size_t first = levels.back().first - patches_.size();
      for (std::uint32_t row = 0; row < parts; ++row)
        for (std::uint32_t column = 0; column < parts - row; ++column)
          for (const bool upper : {false, true}) {
            if (upper && column + row + 1 >= parts) continue;
            const float third = upper ? 2.0f / 3.0f : 1.0f / 3.0f;
            const glm::vec2 middle = (glm::vec2(column, row) + third) / static_cast<float>(parts);
            const std::size_t patch =
                first_patch + TrianglePart{.column = column, .row = row, .upper = upper}.place(parts);
            members_[first + TrianglePart::at(coarse, middle.x, middle.y).place(coarse)].push_back(
                static_cast<std::uint32_t>(patch));
          }
    }
  }
}

std::size_t Patches::regionAt(const RayHit& hit, std::size_t level) const {
  const Level& of = levels_[hit.triangle][level];
  return of.first + TrianglePart::at(of.parts, hit.b, hit.c).place(of.parts);
}

float Patches::areaOf(std::size_t triangle, std::size_t level) const {
  const auto& [a, b, c] = tree_[triangle].corners;
  const auto parts = static_cast<float>(levels_[triangle][level].parts);
  return 0.5f * glm::length(glm::cross(b - a, c - a)) / (parts * parts);
}

std::array<glm::vec3, 3> Patches::cornersAt(const RayHit& hit, std::size_t level) const {
  constexpr float kDrawnIn = 0.1f;
  const auto& [a, b, c] = tree_[hit.triangle].corners;
  const std::uint32_t parts = levels_[hit.triangle][level].parts;
  const TrianglePart part = TrianglePart::at(parts, hit.b, hit.c);
  const glm::vec2 low(part.column, part.row);
  std::array<glm::vec2, 3> at = {low, low + glm::vec2(1, 0), low + glm::vec2(0, 1)};
  if (part.upper) at[0] += 1.0f;
  const glm::vec2 middle = (at[0] + at[1] + at[2]) / 3.0f;
  std::array<glm::vec3, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec2 weights = glm::mix(at[k], middle, kDrawnIn) / static_cast<float>(parts);
    corners[k] = a + weights.x * (b - a) + weights.y * (c - a);
  }
  return corners;
}

std::vector<glm::vec3> Patches::means(std::span<const glm::vec3> by_patch) const {
  std::vector<glm::vec3> all(by_patch.begin(), by_patch.end());
  for (const std::vector<std::uint32_t>& members : members_) {
    glm::vec3 sum(0.0f);
    for (const std::uint32_t patch : members) sum += by_patch[patch];
    all.push_back(members.empty() ? sum : sum / static_cast<float>(members.size()));
  }
  return all;
}

namespace {

constexpr std::size_t kRaysPerPoint = 64;  // for each point of a patch
constexpr float kDone = 1e-4f;
constexpr int kMaxBounces = 256;
constexpr std::size_t kBlock = 64;  // points per unit of work

// Returns a point of the R2 sequence (Roberts 2018), which fills the square evenly for any number of points.
std::array<float, 2> evenPoint(std::size_t index) {
  constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;
  const auto i = static_cast<double>(index) + 1.0;
  const double x = i * kA, y = i * kB;
  return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
}

// Lifts a point of the disc to the hemisphere above it (Malley's method): pdf = cos/pi
glm::vec3 cosineDirection(float u, float v) {
  const float radius = std::sqrt(u), angle = 2.0f * std::numbers::pi_v<float> * v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(1.0f - u, 0.0f))};
}

// Samples the hemisphere uniformly: pdf = 1/(2 pi)
glm::vec3 hemisphereDirection(float u, float v) {
  const float radius = std::sqrt(std::max(1.0f - u * u, 0.0f)), angle = 2.0f * std::numbers::pi_v<float> * v;
  return {radius * std::cos(angle), radius * std::sin(angle), u};
}

std::array<glm::vec3, kLinks> directionsOf(LinkSpread spread) {
  std::array<glm::vec3, kLinks> directions{};
  for (std::size_t i = 0; i < kLinks; ++i) {
    // The points lie on a spiral with the golden angle (Vogel 1979).
    const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(kLinks);
    const float v = static_cast<float>(i) * (std::numbers::phi_v<float> - 1.0f);
    directions[i] = spread == LinkSpread::Cosine ? cosineDirection(u, v) : hemisphereDirection(u, v);
  }
  return directions;
}

std::size_t blocksOf(std::size_t count) {
  return (count + kBlock - 1) / kBlock;
}

float largest(const glm::vec3& v) {
  return std::max({v.r, v.g, v.b});
}

}  // namespace

const std::array<glm::vec3, kLinks>& linkDirections(LinkSpread spread) {
  static const std::array<glm::vec3, kLinks> cosine = directionsOf(LinkSpread::Cosine);
  static const std::array<glm::vec3, kLinks> hemisphere = directionsOf(LinkSpread::Hemisphere);
  return spread == LinkSpread::Cosine ? cosine : hemisphere;
}

LinkFrame linkFrame(const glm::vec3& n) {
  const float facing = n.z >= kFrameTurnsOver ? 1.0f : -1.0f;
  const float a = -1.0f / (facing + n.z), b = n.x * n.y * a;
  return {.x = {1.0f + facing * n.x * n.x * a, facing * b, -facing * n.x},
          .y = {b, facing + n.y * n.y * a, -n.y},
          .z = n};
}

PatchTransport::PatchTransport(const bundle::CaptureProxy& proxy, std::size_t most, int order)
    : patches_(bundle::patchSurfaceOf(proxy), most), order_(order) {
  findShares();
  findNearest(proxy);
  bounced_ = meanBounced();
}

void PatchTransport::findShares() {
  constexpr float kOne = 1.0f / static_cast<float>(kPatchPoints * kRaysPerPoint);
  const std::size_t count = patches_.size(), terms = static_cast<std::size_t>(order_ * order_);
  std::vector<std::vector<Share>> rows(count);
  transfer_.resize(terms * count);
  inParallel(blocksOf(count), 1, [&](std::size_t block) {
    std::vector<std::uint32_t> met;
    std::vector<float> basis(terms);
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      const Patch& patch = patches_.all()[i];
      const LinkFrame frame = linkFrame(patch.normal);
      met.clear();
      // Occlusion is subtracted from the closed form, so that open patches have exact values.
      const std::span<float> transfer = std::span(transfer_).subspan(terms * i, terms);
      sh::unoccludedTransfer(order_, patch.normal, transfer);
      for (std::size_t p = 0; p < kPatchPoints; ++p) {
        for (std::size_t k = 0; k < kRaysPerPoint; ++k) {
          // The points of a patch share one even set of directions, and neighbours share it in part.
          const std::size_t place = p * kRaysPerPoint + k;
          const auto [even, turn] = evenPoint(place + 37 * i);
          const float u =
              (static_cast<float>(place) + even) / static_cast<float>(kPatchPoints * kRaysPerPoint);
          const glm::vec3 direction = frame.turned(cosineDirection(u, turn));
          const auto hit = patches_.tree().first(patch.origins[p], direction);
          if (!hit) continue;
          if (!hit->back) met.push_back(static_cast<std::uint32_t>(patches_.regionAt(*hit, 0)));
          sh::evaluate(order_, direction, basis);
          for (std::size_t c = 0; c < terms; ++c) transfer[c] -= kOne * basis[c];
        }
      }
      std::ranges::sort(met);
      for (const std::uint32_t other : met) {
        if (rows[i].empty() || rows[i].back().patch != other)
          rows[i].push_back({.patch = other, .share = 0.0f});
        rows[i].back().share += kOne;
      }
    }
  });
  first_share_.push_back(0);
  for (const std::vector<Share>& row : rows) {
    shares_.insert(shares_.end(), row.begin(), row.end());
    first_share_.push_back(static_cast<std::uint32_t>(shares_.size()));
  }
}

void PatchTransport::findNearest(const bundle::CaptureProxy& proxy) {
  const bool own = proxy.patches.triangles.empty();
  own_triangles_ = own ? patches_.tree().size() : 0;
  for (std::size_t level = own ? 1 : 0; level < proxy.levels.size(); ++level) {
    bundle::CaptureProxy coarse = proxy;
    coarse.levels = {proxy.levels[level]};
    coarse.patches = {};
    const Patches whole(bundle::patchSurfaceOf(coarse), 1);  // one patch per triangle
    for (const Patch& triangle : whole.all()) {
      auto& nearest = nearest_.emplace_back();
      for (std::size_t p = 0; p < kPatchPoints; ++p) {
        float least = std::numeric_limits<float>::infinity();
        for (std::uint32_t i = 0; i < patches_.size(); ++i) {
          const Patch& patch = patches_.all()[i];
          const float away = glm::distance(triangle.points[p], patch.points[0]);
          // A patch that faces another way counts as farther away.
          const float turned = 0.5f * patches_.extent() * (1.0f - glm::dot(triangle.normal, patch.normal));
          if (away + turned >= least) continue;
          least = away + turned;
          nearest[p] = i;
        }
      }
    }
  }
}

glm::vec3 PatchTransport::direct(std::size_t patch, std::span<const glm::vec4> light) const {
  const std::size_t terms = static_cast<std::size_t>(order_ * order_);
  glm::vec3 sum(0.0f);
  for (std::size_t c = 0; c < terms; ++c) sum += transfer_[terms * patch + c] * glm::vec3(light[c]);
  return sum;
}

float PatchTransport::meanBounced() const {
  const std::vector<glm::vec3> given_off = bounce(std::vector<glm::vec3>(patches_.size(), glm::vec3(1.0f)));
  double bounced = 0.0;  // patches are as large as they count alike in pictures
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    glm::vec3 received(0.0f);
    for (std::uint32_t s = first_share_[i]; s < first_share_[i + 1]; ++s)
      received += shares_[s].share * given_off[shares_[s].patch];
    bounced += double{largest(received)};
  }
  return static_cast<float>(bounced / static_cast<double>(std::max<std::size_t>(patches_.size(), 1)));
}

std::vector<glm::vec3> PatchTransport::bounce(std::span<const glm::vec3> direct) const {
  std::vector<glm::vec3> given_off(patches_.size());
  float brightest = 0.0f;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    given_off[i] = patches_.all()[i].albedo * direct[i];
    brightest = std::max(brightest, largest(glm::abs(given_off[i])));
  }
  if (brightest == 0.0f) return given_off;
  // In a Gauss-Seidel iteration, new values count at once.
  for (int bounces = 0; bounces < kMaxBounces; ++bounces) {
    float change = 0.0f;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      glm::vec3 received = direct[i];
      for (std::uint32_t s = first_share_[i]; s < first_share_[i + 1]; ++s)
        received += shares_[s].share * given_off[shares_[s].patch];
      const glm::vec3 now = patches_.all()[i].albedo * received;
      change = std::max(change, largest(glm::abs(now - given_off[i])));
      given_off[i] = now;
    }
    if (change <= kDone * brightest) break;
  }
  return given_off;
}

glm::vec3 PatchTransport::startNear(const SurfacePoint& point) const {
  const Patch* nearest = nullptr;
  float least = std::numeric_limits<float>::infinity();
  for (const Patch& patch : patches_.all()) {
    const float facing = glm::dot(patch.normal, point.normal);
    const float away = glm::distance(patch.points[0], point.position) * (2.0f - facing);
    if (facing < 0.3f || away >= least) continue;
    least = away;
    nearest = &patch;
  }
  return nearest != nullptr ? patches_.inFront(nearest->points[0], nearest->normal) : point.position;
}

std::size_t PatchTransport::regionFrom(const glm::vec3& origin, const RayHit& hit,
                                       float solid_angle_sr) const {
  constexpr float kLeastCosine = 0.1f;
  constexpr float kAlmost = 0.999f;  // share of the distance to the region
  const std::array<glm::vec3, 3> corners = patches_.tree()[hit.triangle].corners;
  const glm::vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const glm::vec3 way =
      corners[0] + hit.b * (corners[1] - corners[0]) + hit.c * (corners[2] - corners[0]) - origin;
  const float cosine = std::abs(glm::dot(way, across)) / (glm::length(way) * glm::length(across));
  const float covered = solid_angle_sr * glm::dot(way, way) / std::max(cosine, kLeastCosine);
  std::size_t level = 0;
  while (level + 1 < patches_.levelsOf(hit.triangle) &&
         patches_.areaOf(hit.triangle, level + 1) < 4.0f * covered)
    ++level;
  // If something stands in front of a part of the region, light would leak.
  const auto inSight = [&] {
    return std::ranges::none_of(patches_.cornersAt(hit, level), [&](const glm::vec3& corner) {
      return patches_.tree().blocked(origin, corner - origin, kAlmost);
    });
  };
  while (level > 0 && !inSight()) --level;
  return patches_.regionAt(hit, level);
}

std::vector<std::uint16_t> PatchTransport::link(std::span<const SurfacePoint> points,
                                                LinkSpread spread) const {
  const auto& directions = linkDirections(spread);
  std::vector<std::uint16_t> links(kLinks * points.size());
  inParallel(blocksOf(points.size()), 2, [&](std::size_t block) {
    // Returns how many of the rays hit the back of a surface.
    const auto linkFrom = [&](const glm::vec3& origin, std::size_t i) {
      const LinkFrame frame = linkFrame(points[i].normal);
      std::size_t backs = 0;
      for (std::size_t k = 0; k < kLinks; ++k) {
        const std::optional<RayHit> hit = patches_.tree().first(origin, frame.turned(directions[k]));
        backs += hit && hit->back ? 1 : 0;
        std::size_t region = patches_.regionCount();
        if (hit && !hit->back) {
          const float solid_angle = spread == LinkSpread::Cosine ? std::numbers::pi_v<float> / directions[k].z
                                                                 : 2.0f * std::numbers::pi_v<float>;
          region = regionFrom(origin, *hit, solid_angle / static_cast<float>(kLinks));
        }
        links[kLinks * i + k] = static_cast<std::uint16_t>(region);
      }
      return backs;
    };
    for (std::size_t i = block * kBlock; i < std::min(points.size(), (block + 1) * kBlock); ++i)
      if (linkFrom(patches_.inFront(points[i].position, points[i].normal), i) > kLinks / 2)
        linkFrom(startNear(points[i]), i);
  });
  return links;
}

std::vector<glm::vec3> PatchTransport::byTriangle(std::span<const glm::vec3> given_off) const {
  std::vector<glm::vec3> triangles;
  for (std::size_t t = 0; t < own_triangles_; ++t) {
    glm::vec3 sum(0.0f);
    for (std::size_t i = 0; i < patches_.countOf(t); ++i) sum += given_off[patches_.firstOf(t) + i];
    triangles.push_back(sum / static_cast<float>(patches_.countOf(t)));
  }
  for (const auto& nearest : nearest_) {
    glm::vec3 sum(0.0f);
    for (const std::uint32_t patch : nearest) sum += given_off[patch];
    triangles.push_back(sum / static_cast<float>(kPatchPoints));
  }
  return triangles;
}

}  // namespace lambent::lighting
