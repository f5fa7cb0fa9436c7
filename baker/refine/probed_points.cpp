#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/refine/group_refiner.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

namespace {

// The order is that of light and of lobes; visibility matters in all bands that couple the two.
constexpr int kOrder = 5, kVisibilityBands = 2 * kOrder - 1;
constexpr std::size_t kPlainValues = kOrder * kOrder, kGlossyValues = kVisibilityBands * kVisibilityBands;
static_assert(kGlossyValues == ShadowProbe::kMostValues);
// Normals with a larger dot product differ by rounding only.
constexpr float kSameNormal = 1.0f - 1e-6f;

// Adds both halves of the sphere by the points of one, rotated by `turn`.
void addSphere(const DirectionTable& half, const glm::mat3& turn, DirectionTable& table) {
  for (const float sign : {1.0f, -1.0f})
    for (std::size_t i = 0; i < half.size(); ++i) {
      const glm::vec3 d = turn * (sign * glm::vec3(half.x[i], half.y[i], half.z[i]));
      table.x.push_back(d.x), table.y.push_back(d.y), table.z.push_back(d.z);
    }
}

DirectionTable twoSpheres(std::size_t rays) {
  const DirectionTable half = uniformTable(rays / 4);
  DirectionTable table;
  addSphere(half, glm::mat3(1.0f), table);
  // Any rotation will do that brings no axis near another.
  const glm::vec3 a = glm::normalize(glm::vec3(0.46f, 0.71f, 0.53f)),
                  b = glm::normalize(glm::cross(a, glm::vec3(0.8f, -0.1f, 0.6f)));
  addSphere(half, glm::mat3(b, glm::cross(a, b), a), table);
  return table;
}

// Returns weights for errors of irradiance by the power of light in each band, relative to an open point.
std::vector<double> irradianceRoots() {
  double open = 0.0;
  for (int l = 0; l < kOrder; ++l) {
    const double cosine = sh::clampedCosine(l) / std::numbers::pi;
    open +=
        kBandPower[static_cast<std::size_t>(l)] * cosine * cosine * (2 * l + 1) / (4.0 * std::numbers::pi);
  }
  std::vector<double> roots;
  for (std::size_t i = 0; i < kPlainValues; ++i)
    roots.push_back(std::sqrt(kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] / open));
  return roots;
}

// Returns weights for errors of visibility by how its products with lights show in lobes (CodingSettings),
// also relative to an open point.
std::vector<double> visibilityRoots() {
  const sh::GauntTable table = sh::makeGauntTable(kOrder, kOrder);
  std::vector<double> roots(kGlossyValues, 0.0);
  double open = 0.0;
  for (std::size_t i = 0; i < kPlainValues; ++i) {
    const auto band = static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)));
    open += kLobePower[band] * kBandPower[band];
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t) {
      const sh::GauntTerm& term = table.terms[t];
      roots[term.k] += kLobePower[band] * kBandPower[static_cast<std::size_t>(sh::bandOf(term.j))] *
                       double{term.value} * double{term.value};
    }
  }
  for (double& root : roots) root = std::sqrt(root / open);
  return roots;
}

}  // namespace

ShadowProbe::ShadowProbe(std::size_t rays) : directions_(twoSpheres(rays)) {
  const std::vector<double> irradiance = irradianceRoots(), visibility = visibilityRoots();
  const double solid_angle = 8.0 * std::numbers::pi / static_cast<double>(directions_.size());  // of one half
  std::vector<double> basis(kGlossyValues);
  for (std::size_t r = 0; r < directions_.size(); ++r) {
    sh::evaluate<double>(kVisibilityBands, double{directions_.x[r]}, double{directions_.y[r]},
                         double{directions_.z[r]}, basis);
    for (std::size_t i = 0; i < kPlainValues; ++i)
      irradiance_.push_back(static_cast<float>(irradiance[i] * basis[i] * solid_angle / std::numbers::pi));
    for (std::size_t i = 0; i < kGlossyValues; ++i)
      visibility_.push_back(static_cast<float>(visibility[i] * basis[i] * solid_angle));
  }
}

std::span<const float> ShadowProbe::row(std::size_t direction, bool plain) const {
  return plain ? std::span(irradiance_).subspan(direction * kPlainValues, kPlainValues)
               : std::span(visibility_).subspan(direction * kGlossyValues, kGlossyValues);
}

bool ShadowProbe::look(const RayScene& scene, std::span<const SampleOrigin> origins, const glm::vec3& normal,
                       SampleKind kind, std::span<std::uint16_t> masks) const {
  std::fill(masks.begin(), masks.end(), std::uint16_t{0});
  SeenOrigins seen;
  findSeenOrigins(origins, glm::mat3(localFrame(glm::normalize(glm::dvec3(normal)))), scene, inside_test_,
                  seen);
  if (!seen.valid) return false;
  if (kind == SampleKind::Diffuse) {
    scene.trace({seen.origins, glm::mat3(1.0f), directions_, BelowHorizon::Blocked}, masks);
    return true;
  }
  DirectionTable above = directions_;
  for (std::size_t r = 0; r < above.size(); ++r) {
    const float height = above.x[r] * normal.x + above.y[r] * normal.y + above.z[r] * normal.z;
    if (height >= 0.0f) continue;
    above.x[r] -= 2.0f * height * normal.x;
    above.y[r] -= 2.0f * height * normal.y;
    above.z[r] -= 2.0f * height * normal.z;
  }
  scene.trace({seen.origins, glm::mat3(1.0f), above, BelowHorizon::Mirrored}, masks);
  return true;
}

ShadowProbe::Difference ShadowProbe::difference(std::span<const HiddenFrom, 3> corners,
                                                const HiddenFrom& truth, SampleKind kind) const {
  const bool plain = kind == SampleKind::Diffuse;
  const bool cosines_differ = plain && std::ranges::any_of(corners, [&](const HiddenFrom& corner) {
                                return glm::dot(corner.normal, truth.normal) < kSameNormal;
                              });
  Difference wrong{};
  for (std::size_t p = 0; p < packets(); ++p) {
    const unsigned in_any = corners[0].masks[p] | corners[1].masks[p] | corners[2].masks[p] | truth.masks[p],
                   in_all = corners[0].masks[p] & corners[1].masks[p] & corners[2].masks[p] & truth.masks[p];
    // What is hidden from all of them makes no difference, unless their cosines differ.
    for (unsigned left = cosines_differ ? in_any : in_any & ~in_all; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const std::size_t r = p * kPacketWidth + k;
      const glm::vec3 direction(directions_.x[r], directions_.y[r], directions_.z[r]);
      const auto hidden = [&](const HiddenFrom& point) {
        if ((point.masks[p] >> k & 1) == 0) return 0.0f;
        return plain ? std::max(0.0f, glm::dot(point.normal, direction)) : 1.0f;
      };
      float off = -hidden(truth);
      for (const HiddenFrom& corner : corners) off += corner.share * hidden(corner);
      if (off == 0.0f) continue;
      const std::span<const float> from = row(r, plain);
      auto& to = wrong[r < directions_.size() / 2 ? 0 : 1];
      for (std::size_t i = 0; i < from.size(); ++i) to[i] += off * from[i];
    }
  }
  return wrong;
}

ShadowProbe::Difference ShadowProbe::arriving(const HiddenFrom& point, SampleKind kind) const {
  const bool plain = kind == SampleKind::Diffuse;
  Difference light{};
  for (std::size_t r = 0; r < directions_.size(); ++r) {
    if ((point.masks[r / kPacketWidth] >> r % kPacketWidth & 1) != 0) continue;
    const glm::vec3 direction(directions_.x[r], directions_.y[r], directions_.z[r]);
    const float seen = plain ? glm::dot(point.normal, direction) : 1.0f;
    if (!(seen > 0.0f)) continue;
    const std::span<const float> from = row(r, plain);
    auto& to = light[r < directions_.size() / 2 ? 0 : 1];
    for (std::size_t i = 0; i < from.size(); ++i) to[i] += seen * from[i];
  }
  return light;
}

double ShadowProbe::squareError(const Difference& difference) {
  double error = 0.0;
  for (std::size_t i = 0; i < kMostValues; ++i) error += double{difference[0][i]} * double{difference[1][i]};
  return error;
}

float ShadowProbe::openShare(const HiddenFrom& point) const {
  float sum = 0.0f;
  for (std::size_t r = 0; r < directions_.size(); ++r)
    if ((point.masks[r / kPacketWidth] >> r % kPacketWidth & 1) == 0)
      sum += std::max(
          0.0f, glm::dot(point.normal, glm::vec3(directions_.x[r], directions_.y[r], directions_.z[r])));
  return 4.0f * sum /
         static_cast<float>(directions_.size());  // the mean over a sphere of an open point is 1/4
}

namespace {

constexpr std::size_t kPointsOnLamps = 128;  // of all lamps together
constexpr std::size_t kBouncers = 64;
constexpr float kAlbedo = 0.5f;

// Sums up the irradiance of each lamp over pi.
class LampSums : public LightReceiver {
 public:
  explicit LampSums(std::span<float> sums) : sums_(sums) {}
  glm::vec3 direction(std::size_t) const override { return {0, 0, 1}; }
  float raysPerSteradian(float) const override { return 0.0f; }
  void addAlong(std::size_t, std::uint32_t, glm::vec3) override {}
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override {
    sums_[light] += local.z / std::numbers::pi_v<float> * spec::luminanceOf(radiance);
  }

 private:
  std::span<float> sums_;
};

}  // namespace

SurfaceLight::SurfaceLight(const Scene& scene, const GroupGeometry& geometry, const RayScene& rays,
                           const SurfaceColors& colors, std::span<const PlannedLight> lights,
                           const Importance& importance, const ShadowProbe& probe)
    : rays_(rays),
      strengths_(lights.size(), 0.0f),
      emitters_(scene, geometry, colors, lights, kPointsOnLamps) {
  const std::vector<SeenPoint> seen = importance.look(kBouncers * 16, geometry, rays);
  std::vector<std::uint16_t> masks(probe.packets());
  std::vector<float> of_lamps(kBouncers * lights.size(), 0.0f);  // at each bouncer
  const float most_area = 0.25f * importance.extent() * importance.extent();
  for (std::size_t i = 0; i < kBouncers && !seen.empty(); ++i) {
    const SeenPoint& point = seen[i * seen.size() / kBouncers];
    const SampleOrigin origin{.position = point.position, .geometric_normal = point.normal, .weight = 1.0f};
    const std::span<const SampleOrigin> origins(&origin, 1);
    const float density = importance.at({point.position, point.normal}).seen;
    bouncers_.push_back({.position = point.position, .normal = point.normal, .area = most_area});
    Bouncer& bouncer = bouncers_.back();
    if (density > 0.0f) bouncer.area = std::min(1.0f / (float{kBouncers} * density), most_area);
    if (probe.look(rays, origins, point.normal, SampleKind::Diffuse, masks))
      bouncer.sky = kAlbedo * probe.openShare({masks, point.normal});
    mean_sky_ += bouncer.sky / (kAlbedo * float{kBouncers});
    const auto sums = std::span(of_lamps).subspan(i * lights.size(), lights.size());
    addLamps(origins, point.normal, sums);
    for (std::size_t k = 0; k < lights.size(); ++k) strengths_[k] += sums[k] / float{kBouncers};
  }
  for (float& strength : strengths_) {
    if (!(strength > 0.0f)) continue;
    strength = 1.0f / strength;
    mean_lamps_ += 1.0f;
  }
  for (std::size_t i = 0; i < bouncers_.size(); ++i)
    for (std::size_t k = 0; k < lights.size(); ++k)
      bouncers_[i].lamps += kAlbedo * strengths_[k] * of_lamps[i * lights.size() + k];
  float bounced = 0.0f;
  for (const Bouncer& bouncer : bouncers_) {
    const SampleOrigin origin{
        .position = bouncer.position, .geometric_normal = bouncer.normal, .weight = 1.0f};
    bounced += bouncedAt(origin, bouncer.normal).bounced / float{kBouncers};
  }
  mean_sky_ += bounced;
  at_vertices_ = strengths_;
  const std::vector<bool> per_pixel = shadedPerPixel(lights);
  for (std::size_t k = 0; k < lights.size(); ++k)
    if (per_pixel[k]) at_vertices_[k] = 0.0f;
}

void SurfaceLight::addLamps(std::span<const SampleOrigin> origins, const glm::vec3& normal,
                            std::span<float> sums) const {
  if (emitters_.empty() || origins.empty()) return;
  LampSums receiver(sums);
  emitters_.addChosen(origins, glm::mat3(localFrame(glm::normalize(glm::dvec3(normal)))), rays_, receiver);
}

SentLight SurfaceLight::at(std::span<const SampleOrigin> origins, const glm::vec3& normal) const {
  if (origins.empty()) return {};
  SentLight light = bouncedAt(origins[0], normal);
  std::vector<float> of_lamps(at_vertices_.size(), 0.0f);
  addLamps(origins, normal, of_lamps);
  for (std::size_t k = 0; k < of_lamps.size(); ++k) light.lamps += at_vertices_[k] * of_lamps[k];
  return light;
}

SentLight SurfaceLight::bouncedAt(const SampleOrigin& origin, const glm::vec3& normal) const {
  SentLight light;
  std::vector<RaySegment> ways;
  std::vector<const Bouncer*> from;
  std::vector<float> shares;
  for (const Bouncer& bouncer : bouncers_) {
    const glm::vec3 way = bouncer.position - origin.position;
    const float squared = glm::dot(way, way), here = glm::dot(normal, way),
                there = -glm::dot(bouncer.normal, way);
    if (!(here > 0.0f) || !(there > 0.0f)) continue;
    const float distance = std::sqrt(squared);
    ways.push_back({origin.position, way / distance, distance * (1.0f - 1e-4f)});
    from.push_back(&bouncer);
    shares.push_back(here * there / squared * bouncer.area /
                     (std::numbers::pi_v<float> * squared + bouncer.area));
  }
  std::vector<std::uint8_t> blocked(ways.size());
  rays_.occluded(ways, blocked);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (blocked[i] != 0) continue;
    light.bounced += shares[i] * from[i]->sky;
    light.lamps += shares[i] * from[i]->lamps;
  }
  return light;
}

std::uint32_t ProbedPoints::numberOf(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                                     std::span<const SampleOrigin> origins) {
  const auto next = static_cast<std::uint32_t>(seen_.size() + missing_.size());
  // A vertex looks from a little inside the faces around it. Once these are split it looks from elsewhere,
  // and is another point.
  std::uint32_t from = 0;
  for (const SampleOrigin& origin : origins)
    for (int k = 0; k < 3; ++k) from = from * 0x9E3779B1u + std::bit_cast<std::uint32_t>(origin.position[k]);
  VertexKey key = vertexKey(position, normal, kind);
  key.back() = from;
  const auto [entry, is_new] = known_.try_emplace(key, next);
  if (is_new) missing_.push_back({normal, kind, {origins.begin(), origins.end()}});
  return entry->second;
}

bool ProbedPoints::probe(const Key& scene_key, const RayScene& rays, const SurfaceLight& light,
                         const BakeContext& context) {
  const std::vector<Point> points = std::exchange(missing_, {});
  if (points.empty()) return true;
  const std::size_t size = probe_->packets(), first = seen_.size();
  seen_.resize(first + points.size());
  light_.resize(seen_.size());
  masks_.resize(seen_.size() * size);
  const auto masks = std::span(masks_).subspan(first * size);
  const auto compute = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Point& point = points[i];
      seen_[first + i] =
          probe_->look(rays, point.origins, point.normal, point.kind, masks.subspan(i * size, size));
      if (seen_[first + i] != 0) light_[first + i] = light.at(point.origins, point.normal);
    }
  };
  const auto begin = static_cast<std::ptrdiff_t>(first);
  const Stage stage{.count = points.size(),
                    .grain = kPointsPerRange,
                    .writes = {rowsOf(masks, size), rowsOf(seen_, 1, begin), rowsOf(light_, 1, begin)},
                    .compute = compute,
                    .keep = KeepWhen::Always};
  KeyMaker key;
  key.add(scene_key).add(std::uint64_t{probe_->rays()});
  for (const Point& point : points) key.add(point.normal).add(point.kind).addList(point.origins);
  const auto done = runStage(stage, context.keyed(key.key()));
  if (!done) return false;
  traced_ += done->computed * probe_->rays();
  kept_ += done->found * probe_->rays();
  return true;
}

}  // namespace lambent::baker
