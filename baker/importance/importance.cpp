#include "baker/importance/importance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/texel_samples.hpp"

namespace lambent::baker {

Regions::Regions(std::vector<glm::vec3> points, int depth) {
  if (points.empty()) return;
  depth_ = depth;
  cuts_.resize(size() - 1);
  std::vector<std::span<glm::vec3>> parts(cuts_.size() + size());
  parts[0] = points;
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const std::span<glm::vec3> part = parts[i];
    if (part.empty()) continue;
    glm::vec3 low = part[0], high = low;
    for (const glm::vec3& p : part) low = glm::min(low, p), high = glm::max(high, p);
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), middle, part.end(),
                     [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
    cuts_[i] = {axis, (*middle)[axis]};
    const auto left = static_cast<std::size_t>(middle - part.begin());
    parts[2 * i + 1] = part.first(left);
    parts[2 * i + 2] = part.subspan(left);
  }
}

std::size_t Regions::at(const glm::vec3& position) const {
  std::size_t i = 0;
  while (i < cuts_.size()) i = 2 * i + (position[cuts_[i].axis] < cuts_[i].at ? 1 : 2);
  return i - cuts_.size();
}

double boundingError(std::span<const double> errors, std::span<const double> weights) {
  constexpr double kShare = 0.95;
  std::vector<std::pair<double, double>> sorted;
  double all = 0.0;
  for (std::size_t r = 0; r < errors.size(); ++r)
    if (weights[r] > 0.0) sorted.emplace_back(errors[r], weights[r]), all += weights[r];
  std::ranges::sort(sorted);
  double sum = 0.0;
  for (const auto& [error, weight] : sorted)
    if ((sum += weight) >= kShare * all) return error;
  return 0.0;
}

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kFirstLook = 8192;  // rays that say what is seen
constexpr std::size_t kSenders = 24;
constexpr int kRegionDepth = 6;  // 64 regions
// Eyes that come nearer than this share of the distance to what they see on average see no more of it.
constexpr float kNearest = 0.02f;
// Sent light is summed over many senders, so its errors show less than those of what is seen.
constexpr float kSentCounts = 0.25f;
constexpr float kMiddle = 0.9f;      // of what is seen, along each axis, lies within the extent
constexpr std::size_t kGrain = 256;  // samples of one range of work

}  // namespace

Importance::Importance(const GroupGeometry& geometry, const RayScene& rays, std::vector<Eye> cameras)
    : geometry_(&geometry), rays_(&rays), eyes_(placeEyes(geometry, rays, std::move(cameras))) {
  seen_shares_.assign(eyes_.size(), 1.0f);
  const std::vector<SeenPoint> seen = look(kFirstLook, geometry, rays);
  if (seen.empty()) return;
  std::vector<float> counts(eyes_.size(), 0.0f);
  for (const SeenPoint& point : seen) counts[point.eye] += 1.0f;
  for (std::size_t e = 0; e < eyes_.size(); ++e)
    seen_shares_[e] =
        std::max(counts[e] / std::max(1.0f, std::round(eyes_[e].weight * float{kFirstLook})), 1e-3f);

  std::vector<glm::vec3> points;
  for (const SeenPoint& point : seen) points.push_back(point.position);
  glm::vec3 size(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> along;
    for (const glm::vec3& p : points) along.push_back(p[axis]);
    std::ranges::sort(along);
    const auto last = static_cast<float>(along.size() - 1);
    const float low = along[static_cast<std::size_t>(0.5f * (1.0f - kMiddle) * last)];
    const float high = along[static_cast<std::size_t>(0.5f * (1.0f + kMiddle) * last)];
    size[axis] = high - low;
    middle_[axis] = 0.5f * (low + high);
  }
  extent_ = std::max(glm::length(size), 1e-6f * glm::distance(geometry.bounds_min, geometry.bounds_max));
  regions_ = Regions(std::move(points), kRegionDepth);

  for (std::size_t i = 0; i < kSenders; ++i) {
    const SeenPoint& point = seen[i * seen.size() / kSenders];
    Sender sender{.place = {point.position, point.normal}, .share = 1.0f / float{kSenders}};
    const float density = mostSeen(sender.place);
    sender.area = density > 0.0f ? sender.share / density : 0.0f;
    senders_.push_back(sender);
  }
}

std::vector<SeenPoint> Importance::look(std::size_t rays_in_all, const GroupGeometry& geometry,
                                        const RayScene& rays) const {
  std::vector<SeenPoint> seen;
  constexpr float kReach = std::numeric_limits<float>::max();
  std::uint32_t first_ray = 0;
  for (std::uint32_t e = 0; e < eyes_.size(); ++e) {
    const Eye& eye = eyes_[e];
    const auto count = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(eye.weight * static_cast<float>(rays_in_all))));
    std::vector<RaySegment> segments;
    for (std::size_t i = 0; i < count; ++i) segments.push_back({eye.position, eye.direction(i), kReach});
    std::vector<FirstHit> hits(count);
    rays.firstHits(segments, hits);
    const std::size_t first = seen.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (!hits[i].any() || hits[i].back) continue;
      const glm::vec3 across = areaNormal(geometry, geometry.triangles[hits[i].triangle]);
      const float length = glm::length(across);
      if (!(length > 0.0f)) continue;
      const glm::vec3 normal = across / length,
                      position = eye.position + hits[i].distance * segments[i].direction;
      seen.push_back({.hit = hits[i],
                      .position = position + standOff(position, std::sqrt(length)) * normal,
                      .normal = normal,
                      .to_eye = -segments[i].direction,
                      .eye = e,
                      .ray = first_ray + static_cast<std::uint32_t>(i)});
    }
    first_ray += static_cast<std::uint32_t>(count);
    for (std::size_t i = first; i < seen.size(); ++i)
      seen[i].share = eye.weight / static_cast<float>(seen.size() - first);
  }
  float sum = 0.0f;
  for (const SeenPoint& point : seen) sum += point.share;
  for (SeenPoint& point : seen) point.share /= sum;
  return seen;
}

// Returns what the eye would see per square metre if nothing hid it, and the way to the eye.
float Importance::densityAt(const Eye& eye, const Place& place, glm::vec3& way) const {
  way = eye.position - place.position;
  const float squared = glm::dot(way, way), facing = glm::dot(place.normal, way);
  if (!(facing > 0.0f)) return 0.0f;
  const float distance = std::sqrt(squared);
  const float density = eye.density(-way / distance);
  if (!(density > 0.0f)) return 0.0f;
  const float nearest = kNearest * extent_;
  const float seen_share = seen_shares_[static_cast<std::size_t>(&eye - eyes_.data())];
  return eye.weight * density * facing / distance / ((squared + nearest * nearest) * seen_share);
}

float Importance::mostSeen(const Place& place) const {
  float sum = 0.0f;
  glm::vec3 way;
  for (const Eye& eye : eyes_) sum += densityAt(eye, place, way);
  return sum;
}

ImportanceAt Importance::at(const Place& place) const {
  std::vector<RaySegment> ways;
  std::vector<float> brings;
  const auto add = [&](const glm::vec3& way, float value) {
    const float distance = glm::length(way);
    ways.push_back({place.position, way / distance, distance * (1.0f - 1e-4f)});
    brings.push_back(value);
  };
  glm::vec3 way;
  for (const Eye& eye : eyes_)
    if (const float density = densityAt(eye, place, way); density > 0.0f) add(way, density);
  const std::size_t of_eyes = ways.size();
  for (const Sender& sender : senders_) {
    way = sender.place.position - place.position;
    const float squared = glm::dot(way, way), here = glm::dot(place.normal, way),
                there = -glm::dot(sender.place.normal, way);
    if (!(here > 0.0f) || !(there > 0.0f)) continue;
    // The sender is a small disc of its area, so what is near it does not see a point.
    add(way, sender.share * here * there / (squared * kPi * (squared + sender.area / kPi)));
  }
  std::vector<std::uint8_t> blocked(ways.size());
  rays_->occluded(ways, blocked);
  ImportanceAt at;
  for (std::size_t i = 0; i < ways.size(); ++i)
    if (blocked[i] == 0) (i < of_eyes ? at.seen : at.sent) += brings[i];
  return at;
}

SampleImportance Importance::ofSamples(const SampleSet& samples) const {
  const std::vector<float> areas = sampleAreas(*geometry_, samples);
  SampleImportance importance{std::vector<float>(samples.size(), 0.0f), {}, regions_.size(), extent_};
  std::vector<float>& shares = importance.shares;
  for (const glm::vec3& position : samples.positions)
    importance.regions.push_back(static_cast<std::uint32_t>(regions_.at(position)));
  parallelRanges(samples.size(), kGrain, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto origins = samples.originsOf(s);
      if (origins.empty()) continue;
      const ImportanceAt here = at({origins[0].position, samples.normals[s]});
      shares[s] = areas[s] * (here.seen + kSentCounts * here.sent);
    }
  });
  // A sample at the edge of a large face counts by what is seen of the face.
  for (const SeenPoint& point : look(kFirstLook, *geometry_, *rays_)) {
    const glm::vec3 weights(1.0f - point.hit.u - point.hit.v, point.hit.u, point.hit.v);
    for (const auto& [sample, share] : shownSamples(*geometry_, samples, point.hit.triangle, weights))
      if (sample != kNoSample) shares[sample] += share * point.share;
  }
  return importance;
}

}  // namespace lambent::baker
