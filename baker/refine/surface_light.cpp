#include "baker/refine/surface_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kPointsOnLamps = 128;  // of all lamps together
constexpr std::size_t kBouncers = 64;
constexpr float kAlbedo = 0.5f;

float luminance(const glm::vec3& color) {
  return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

// Sums up the irradiance of each lamp over pi.
class LampSums : public LightReceiver {
 public:
  explicit LampSums(std::span<float> sums) : sums_(sums) {}
  glm::vec3 direction(std::size_t) const override { return {0, 0, 1}; }
  float raysPerSteradian(float) const override { return 0.0f; }
  void addAlong(std::size_t, std::uint32_t, glm::vec3) override {}
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override {
    sums_[light] += local.z / std::numbers::pi_v<float> * luminance(radiance);
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

}  // namespace lambent::baker
