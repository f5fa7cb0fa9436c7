#include "baker/bake/view_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/transport/sample_areas.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kEyes = 24, kRaysOfEye = 48;
constexpr std::size_t kPlacesTried = 512;  // for eyes in a room
// An eye stands in a room if this share of its rays meet a front, and in something if this share meet a back.
constexpr float kEnclosed = 0.7f, kInside = 0.1f;
// Eyes around a body stand so many radii of its bounding sphere from its middle, as the default camera does.
constexpr float kRadii = 2.5f;

// Returns the i-th of the numbers of van der Corput in this base.
float radicalInverse(std::size_t i, std::size_t base) {
  double inverse = 0.0, digit = 1.0;
  for (; i > 0; i /= base) {
    digit /= static_cast<double>(base);
    inverse += digit * static_cast<double>(i % base);
  }
  return static_cast<float>(inverse);
}

// Returns the i-th of n directions that are spread evenly over the sphere (a spiral of golden angles).
glm::vec3 spiral(std::size_t i, std::size_t n) {
  const float y = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
  const float round = std::sqrt(std::max(0.0f, 1.0f - y * y));
  const float turn = static_cast<float>(i) * std::numbers::pi_v<float> * (3.0f - std::sqrt(5.0f));
  return {round * std::cos(turn), y, round * std::sin(turn)};
}

using Eye = std::vector<RaySegment>;  // its rays

// Returns eyes in free space inside the group that surfaces enclose.
std::vector<Eye> eyesInRooms(const TracedScene& scene, float reach) {
  const GroupGeometry& geometry = scene.geometry;
  std::vector<Eye> eyes;
  std::vector<FirstHit> hits(kRaysOfEye);
  for (std::size_t place = 1; place <= kPlacesTried && eyes.size() < kEyes; ++place) {
    const glm::vec3 share(radicalInverse(place, 2), radicalInverse(place, 3), radicalInverse(place, 5));
    const glm::vec3 at = glm::mix(geometry.bounds_min, geometry.bounds_max, share);
    Eye eye;
    for (std::size_t i = 0; i < kRaysOfEye; ++i) eye.push_back({at, spiral(i, kRaysOfEye), reach});
    scene.rays.firstHits(eye, hits);
    std::size_t fronts = 0, backs = 0;
    for (const FirstHit& hit : hits) fronts += hit.any() && !hit.back, backs += hit.back;
    if (static_cast<float>(fronts) >= kEnclosed * kRaysOfEye &&
        static_cast<float>(backs) <= kInside * kRaysOfEye)
      eyes.push_back(std::move(eye));
  }
  return eyes;
}

// Returns eyes around the group that look at its bounding sphere, from a little above to a little below.
std::vector<Eye> eyesAround(const TracedScene& scene, float reach) {
  const GroupGeometry& geometry = scene.geometry;
  const glm::vec3 middle = 0.5f * (geometry.bounds_min + geometry.bounds_max);
  const float radius = 0.5f * glm::distance(geometry.bounds_min, geometry.bounds_max);
  std::vector<Eye> eyes;
  for (std::size_t e = 0; e < kEyes; ++e) {
    const glm::vec3 from = spiral(kEyes / 4 + e / 2, kEyes);  // none straight above or below
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), from)),
                    up = glm::cross(from, right);
    const glm::vec3 at = middle + kRadii * radius * from;
    Eye& eye = eyes.emplace_back();
    for (std::size_t i = 0; i < kRaysOfEye; ++i) {
      const std::size_t number = e * kRaysOfEye + i + 1;
      const float out = radius * std::sqrt(radicalInverse(number, 2)),
                  turn = 2.0f * std::numbers::pi_v<float> * radicalInverse(number, 3);
      const glm::vec3 to = middle + out * (std::cos(turn) * right + std::sin(turn) * up);
      eye.push_back({at, glm::normalize(to - at), reach});
    }
  }
  return eyes;
}

void addPoint(const TracedScene& scene, const FirstHit& hit, std::uint32_t eye, ViewPoints& out) {
  const GroupGeometry& geometry = scene.geometry;
  const glm::uvec3 corners = geometry.triangles[hit.triangle];
  const SampleStretch& diffuse = scene.samples.diffuse;
  if (const std::uint32_t sample = scene.samples.vertex_sample[corners.x];
      sample < diffuse.begin || sample >= diffuse.end)
    return;
  if (!(triangleArea(geometry, corners) > 0.0)) return;
  const glm::vec3 weights(1.0f - hit.u - hit.v, hit.u, hit.v);
  const FacePoint point = facePoint(geometry, corners, weights);
  if (!(glm::dot(point.normal, point.origin.geometric_normal) > 0.0f)) return;
  SampleSet& set = out.points.samples;
  out.points.triangles.push_back(hit.triangle);
  set.positions.push_back(point.position);
  set.normals.push_back(point.normal);
  set.origins.push_back(point.origin);
  set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
  out.weights.push_back(weights);
  out.albedos.push_back(scene.colors.albedo(hit.triangle, hit.u, hit.v));
  out.eyes.push_back(eye);
}

}  // namespace

ViewPoints viewPoints(const TracedScene& scene) {
  const float diagonal = glm::distance(scene.geometry.bounds_min, scene.geometry.bounds_max);
  std::vector<Eye> eyes = eyesInRooms(scene, diagonal);
  if (eyes.empty()) eyes = eyesAround(scene, (kRadii + 1.0f) * diagonal);
  ViewPoints out;
  out.points.samples.origin_offsets.push_back(0);
  std::vector<FirstHit> hits(kRaysOfEye);
  for (std::uint32_t e = 0; e < eyes.size(); ++e) {
    scene.rays.firstHits(eyes[e], hits);
    for (const FirstHit& hit : hits)
      if (hit.any() && !hit.back) addPoint(scene, hit, e, out);
  }
  SampleSet& set = out.points.samples;
  set.diffuse = {0, set.size()};
  set.normal_mapped = set.glossy = {set.size(), set.size()};
  return out;
}

}  // namespace lambent::baker
