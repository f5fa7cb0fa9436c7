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

// A Seer collects what eyes see.
class Seer {
 public:
  explicit Seer(const TracedScene& scene) : scene_(scene) {
    for (ViewPoints* points : {&view_.diffuse, &view_.glossy})
      points->points.samples.origin_offsets.push_back(0);
  }

  void add(const Eye& eye) {
    std::vector<FirstHit> hits(eye.size());
    scene_.rays.firstHits(eye, hits);
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i].any() && !hits[i].back) add(hits[i], -eye[i].direction);
    ++view_.eyes;
  }

  View finish() {
    const std::size_t step = (glossy_.size() + kMostGlossyPoints - 1) / kMostGlossyPoints;
    for (std::size_t i = 0; i < glossy_.size(); i += step) add(glossy_[i], view_.glossy);
    view_.glossy.stands_for = static_cast<std::uint32_t>(step);
    SampleSet &diffuse = view_.diffuse.points.samples, &glossy = view_.glossy.points.samples;
    diffuse.diffuse = {0, diffuse.size()};
    diffuse.normal_mapped = diffuse.glossy = {diffuse.size(), diffuse.size()};
    glossy.glossy = {0, glossy.size()};
    return std::move(view_);
  }

 private:
  struct Seen {
    FirstHit hit;
    glm::vec3 to_eye;
    std::uint32_t eye;
    FacePoint point;
  };

  void add(const FirstHit& hit, const glm::vec3& to_eye) {
    const GroupGeometry& geometry = scene_.geometry;
    const glm::uvec3 corners = geometry.triangles[hit.triangle];
    const std::uint32_t sample = scene_.samples.vertex_sample[corners.x];
    const auto in = [&](const SampleStretch& stretch) {
      return sample >= stretch.begin && sample < stretch.end;
    };
    const bool glossy = in(scene_.samples.glossy);
    if (!glossy && !in(scene_.samples.diffuse)) return;
    if (!(triangleArea(geometry, corners) > 0.0)) return;
    const FacePoint point = facePoint(geometry, corners, {1.0f - hit.u - hit.v, hit.u, hit.v});
    if (!(glm::dot(point.normal, point.origin.geometric_normal) > 0.0f)) return;
    const Seen seen{hit, to_eye, view_.eyes, point};
    if (glossy)
      glossy_.push_back(seen);
    else
      add(seen, view_.diffuse);
  }

  static void add(const Seen& seen, ViewPoints& out) {
    SampleSet& set = out.points.samples;
    out.points.triangles.push_back(seen.hit.triangle);
    set.positions.push_back(seen.point.position);
    set.normals.push_back(seen.point.normal);
    set.origins.push_back(seen.point.origin);
    set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
    out.weights.emplace_back(1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v);
    out.to_eyes.push_back(seen.to_eye);
    out.eyes.push_back(seen.eye);
  }

  const TracedScene& scene_;
  View view_;
  std::vector<Seen> glossy_;
};

}  // namespace

View viewPoints(const TracedScene& scene) {
  const float diagonal = glm::distance(scene.geometry.bounds_min, scene.geometry.bounds_max);
  std::vector<Eye> eyes = eyesInRooms(scene, diagonal);
  if (eyes.empty()) eyes = eyesAround(scene, (kRadii + 1.0f) * diagonal);
  Seer seer(scene);
  for (const Eye& eye : eyes) seer.add(eye);
  return seer.finish();
}

}  // namespace lambent::baker
