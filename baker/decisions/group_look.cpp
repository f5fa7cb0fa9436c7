#include "baker/decisions/group_look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/bake/options.hpp"
#include "baker/bake/ship_meshes.hpp"
#include "baker/compress/light_weights.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/direction_table.hpp"
#include "baker/transport/face_points.hpp"
#include "baker/transport/frame.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/sample_areas.hpp"
#include "baker/transport/surface_colors.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kPoints = 768, kLeastPointsOfDraw = 16;
constexpr std::size_t kPathsOfPoint = 32, kRaysOfVector = 256;
constexpr std::size_t kVectorEvery = 4;  // bands are told from every so many-th point
constexpr int kBands = 8;
constexpr double kTooLittle = 1e-4;  // what a path still carries when it ends

using Vector = std::array<float, kBands * kBands>;

// A stream of numbers in [0, 1), the same for the same seed (PCG: O'Neill 2014).
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 6364136223846793005u + 1442695040888963407u) {}
  float next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    const auto shifted = static_cast<std::uint32_t>(((state_ >> 18) ^ state_) >> 27);
    const auto turn = static_cast<std::uint32_t>(state_ >> 59);
    const std::uint32_t mixed = (shifted >> turn) | (shifted << ((32u - turn) & 31u));
    return static_cast<float>(mixed >> 8) * 0x1p-24f;
  }

 private:
  std::uint64_t state_;
};

glm::vec3 turned(const DirectionTable& table, std::size_t ray, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * table.x[ray] - s * table.y[ray], s * table.x[ray] + c * table.y[ray], table.z[ray]};
}

glm::vec3 cosineDirection(Numbers& numbers) {
  const float square = numbers.next(), turn = 2.0f * std::numbers::pi_v<float> * numbers.next();
  const float out = std::sqrt(square);
  return {out * std::cos(turn), out * std::sin(turn), std::sqrt(std::max(0.0f, 1.0f - square))};
}

// One rigid group, and the sums of what its rays say.
class Looker {
 public:
  Looker(const GroupGeometry& geometry, const RayScene& rays, const SurfaceColors& colors)
      : geometry_(geometry),
        rays_(rays),
        colors_(colors),
        few_(cosineTable(kPathsOfPoint)),
        many_(cosineTable(kRaysOfVector)),
        reach_(4.0f * glm::distance(geometry.bounds_min, geometry.bounds_max) + 1.0f) {}

  GroupLook look() {
    look_.draws.resize(geometry_.draws.size());
    double area = 0.0;
    for (std::size_t d = 0; d < look_.draws.size(); ++d) area += look_.draws[d].area = areaOf(d);
    if (!(area > 0.0)) return std::move(look_);
    for (std::size_t d = 0; d < look_.draws.size(); ++d) lookFrom(d, area);
    look_.all.area = area;
    finish();
    return std::move(look_);
  }

 private:
  double areaOf(std::size_t d) const {
    const DrawGeometry& draw = geometry_.draws[d];
    double sum = 0.0;
    for (std::uint32_t t = 0; t < draw.triangle_count; ++t)
      sum += triangleArea(geometry_, geometry_.triangles[draw.first_triangle + t]);
    return sum;
  }

  void lookFrom(std::size_t d, double all_area) {
    SurfaceLook& of = look_.draws[d];
    if (!(of.area > 0.0)) return;
    const DrawGeometry& draw = geometry_.draws[d];
    const auto count = std::max(kLeastPointsOfDraw,
                                static_cast<std::size_t>(static_cast<double>(kPoints) * of.area / all_area));
    const double weight = of.area / all_area / static_cast<double>(count);
    std::uint32_t t = draw.first_triangle;
    double passed = 0.0, direct = 0.0, bounced = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * of.area;
      const std::uint32_t end = draw.first_triangle + draw.triangle_count;
      for (double own = triangleArea(geometry_, geometry_.triangles[t]); t + 1 < end && passed + own < at;
           own = triangleArea(geometry_, geometry_.triangles[t]))
        passed += own, ++t;
      if (!(triangleArea(geometry_, geometry_.triangles[t]) > 0.0)) continue;
      Numbers numbers(points_++);
      const float root = std::sqrt(numbers.next()), along = numbers.next();
      const FacePoint point =
          facePoint(geometry_, geometry_.triangles[t], {1.0f - root, root * (1.0f - along), root * along});
      const auto [from_sky, from_surfaces] = followFrom(point, weight, numbers);
      direct += from_sky, bounced += from_surfaces;
      if (points_ % kVectorEvery == 0) addVectors(point, weight, numbers);
    }
    of.hidden = 1.0 - direct / static_cast<double>(count);
    of.bounced = direct + bounced > 0.0 ? bounced / (direct + bounced) : 0.0;
    look_.all.hidden += of.area / all_area * of.hidden;
  }

  struct Path {
    double carried = 1.0;
    bool goes = true;
  };

  // Returns what arrives at a point from the sky, and by surfaces.
  std::pair<double, double> followFrom(const FacePoint& point, double weight, Numbers& numbers) {
    const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(point.normal))));
    const float turn = 2.0f * std::numbers::pi_v<float> * numbers.next();
    const double each = 1.0 / static_cast<double>(few_.size());
    std::vector<RaySegment> rays;
    std::vector<Path> paths;
    double below = 0.0;
    for (std::size_t ray = 0; ray < few_.size(); ++ray) {
      const glm::vec3 along = frame * turned(few_, ray, turn);
      // The face itself hides some directions from a shading normal, which is no shadow.
      if (!(glm::dot(along, point.origin.geometric_normal) > 0.0f)) {
        below += each;
        continue;
      }
      rays.push_back({point.origin.position, along, reach_});
      paths.push_back({});
    }
    double direct = below, bounced = 0.0;
    std::vector<FirstHit> hits;
    for (std::size_t bounce = 0; bounce <= BakeOptions::kMostBounces && !rays.empty(); ++bounce) {
      hits.assign(rays.size(), {});
      rays_.firstHits(rays, hits);
      look_.rays += rays.size();
      std::size_t left = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].any()) {
          (bounce == 0 ? direct : bounced) += each * paths[i].carried;
          escaped_[bounce] += weight * each * paths[i].carried;
          continue;
        }
        met_[bounce] += weight * each * paths[i].carried;
        if (hits[i].back) continue;
        const glm::vec3 albedo = colors_.albedo(hits[i].triangle, hits[i].u, hits[i].v);
        const double carried = paths[i].carried * double{(albedo.r + albedo.g + albedo.b) / 3.0f};
        if (carried < kTooLittle) continue;
        if (const auto next = leave(hits[i], numbers)) rays[left] = *next, paths[left++] = {carried};
      }
      rays.resize(left), paths.resize(left);
    }
    escaped_[0] += weight * below;
    return {direct, bounced};
  }

  // Returns a ray that goes on from a hit, or nothing if it would go below its face.
  std::optional<RaySegment> leave(const FirstHit& hit, Numbers& numbers) const {
    const FacePoint at =
        facePoint(geometry_, geometry_.triangles[hit.triangle], {1.0f - hit.u - hit.v, hit.u, hit.v});
    const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(at.origin.geometric_normal))));
    return RaySegment{at.origin.position, frame * cosineDirection(numbers), reach_};
  }

  // Two vectors whose noise is not the same tell the power of bands without it.
  void addVectors(const FacePoint& point, double weight, Numbers& numbers) {
    const Vector one = vectorAt(point, numbers.next()), two = vectorAt(point, numbers.next());
    for (std::size_t i = 0; i < one.size(); ++i)
      power_[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] +=
          weight * double{one[i]} * double{two[i]};
  }

  Vector vectorAt(const FacePoint& point, float turn) {
    const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(point.normal))));
    std::vector<RaySegment> rays;
    for (std::size_t ray = 0; ray < many_.size(); ++ray) {
      const glm::vec3 along = frame * turned(many_, ray, 2.0f * std::numbers::pi_v<float> * turn);
      if (glm::dot(along, point.origin.geometric_normal) > 0.0f)
        rays.push_back({point.origin.position, along, reach_});
    }
    std::vector<std::uint8_t> blocked(rays.size());
    rays_.occluded(rays, blocked);
    look_.rays += rays.size();
    Vector sum{};
    Vector y{};
    for (std::size_t r = 0; r < rays.size(); ++r) {
      if (blocked[r]) continue;
      sh::evaluate(kBands, rays[r].direction, std::span<float>(y));
      for (std::size_t i = 0; i < y.size(); ++i) sum[i] += y[i];
    }
    for (float& value : sum) value /= static_cast<float>(many_.size());
    return sum;
  }

  void finish() {
    double seen = 0.0;
    for (const double light : escaped_) seen += light;
    // Light that surfaces give off arrives where it meets a surface, after so many bounces.
    const auto& passes = seen > kTooLittle ? escaped_ : met_;
    double sum = 0.0;
    for (const double pass : passes) sum += pass;
    for (const double pass : passes) look_.passes.push_back(sum > 0.0 ? pass / sum : 0.0);
    look_.all.bounced = look_.after(0);
    std::array<double, kBands + 1> from{};
    for (std::size_t band = kBands; band-- > 0;)
      from[band] = from[band + 1] + std::max(0.0, kBandPower[band] * power_[band]);
    for (std::size_t band = 0; band < kBands; ++band)
      look_.from_band.push_back(from[0] > 0.0 ? std::sqrt(from[band] / from[0]) : 0.0);
  }

  const GroupGeometry& geometry_;
  const RayScene& rays_;
  const SurfaceColors& colors_;
  DirectionTable few_, many_;
  float reach_;
  GroupLook look_;
  std::uint64_t points_ = 0;
  std::array<double, BakeOptions::kMostBounces + 1> escaped_{}, met_{};
  std::array<double, kBands> power_{};
};

}  // namespace

double GroupLook::after(std::size_t bounces) const {
  double sum = 0.0;
  for (std::size_t pass = bounces + 1; pass < passes.size(); ++pass) sum += passes[pass];
  return sum;
}

Result<std::vector<GroupLook>> lookAt(const Scene& scene, const std::vector<RigidGroup>& groups,
                                      const AlphaMaps& alpha_maps, DecodedImages& images) {
  const auto meshes = splitMeshes(scene, groups, /*max_edge_m=*/0.0f);
  if (!meshes) return failAgain(meshes.error());
  std::vector<GroupLook> looks;
  for (const RigidGroup& group : groups) {
    GroupLook& look = looks.emplace_back();
    if (group.draws.empty()) continue;
    const GroupGeometry geometry = buildGroupGeometry(group, scene, *meshes, /*with_glossy=*/true);
    const auto lights = findGroupLights(scene, group);
    const auto colors = SurfaceColors::load(scene, geometry, lights, images);
    if (!colors) return failAgain(colors.error());
    const auto rays = RayScene::build(geometry, scene, alpha_maps);
    if (!rays) return failAgain(rays.error());
    look = Looker(geometry, *rays, *colors).look();
  }
  return looks;
}

}  // namespace lambent::baker
