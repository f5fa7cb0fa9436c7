#include "baker/effects/diffuse/direct.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/effects/diffuse/hemisphere.hpp"
#include "baker/trace/emitters.hpp"
#include "baker/trace/traced_samples.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/direction_table.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

namespace {

// Receives the light of a group's emitters at a diffuse sample: E/pi at its own normal and, if the surface
// has a normal map, the nine values of hemisphere.hpp.

// LightSums are the columns to which light of one sample is added: values[(output * channels + channel) *
// columns + first_column + k].
struct LightSums {
  std::span<float> scalar;    // one output: E/pi at the sample's normal
  std::span<float> incident;  // nine outputs, local frame; empty for plain samples
  std::uint32_t channels = 1, columns = 0, first_column = 0;

  void add(std::uint32_t light, glm::vec3 radiance, float weight,
           const std::array<float, kIncident>* incident_weights) const;
};

// A LambertReceiver adds up E/pi, and the nine values of normal-mapped samples.
class LambertReceiver : public LightReceiver {
 public:
  LambertReceiver(const Hemisphere& hemisphere, const LightSums& sums)
      : hemisphere_(hemisphere), sums_(sums) {}
  glm::vec3 direction(std::size_t ray) const override { return hemisphere_.direction(ray); }
  float raysPerSteradian(float cosine) const override { return hemisphere_.raysPerSteradian(cosine); }
  void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) override;
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override;

 private:
  const Hemisphere& hemisphere_;
  LightSums sums_;
};

constexpr float kPi = std::numbers::pi_v<float>;

void LightSums::add(std::uint32_t light, glm::vec3 radiance, float weight,
                    const std::array<float, kIncident>* incident_weights) const {
  for (std::uint32_t c = 0; c < channels; ++c) {
    const float value = radiance[static_cast<int>(c)];
    const std::size_t at = std::size_t{c} * columns + first_column + light;
    scalar[at] += weight * value;
    if (!incident_weights) continue;
    for (std::size_t j = 0; j < kIncident; ++j)
      incident[j * channels * columns + at] += (*incident_weights)[j] * value;
  }
}

void LambertReceiver::addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) {
  sums_.add(light, radiance, static_cast<float>(hemisphere_.weight(ray)),
            hemisphere_.hasIncident() ? &hemisphere_.incidentWeight(ray) : nullptr);
}

void LambertReceiver::addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) {
  if (hemisphere_.hasIncident()) {
    const auto incident = hemisphere_.incident(local);
    sums_.add(light, radiance, local.z / kPi, &incident);
  } else {
    sums_.add(light, radiance, local.z / kPi, nullptr);
  }
}

constexpr int kIncidentOrder = 3;

TransferField makeField(std::size_t samples, int order, std::uint32_t outputs, std::uint32_t channels,
                        std::uint32_t columns) {
  TransferField field{
      .order = order, .outputs = outputs, .channels = channels, .columns = columns, .vectors = {}};
  field.vectors.resize(samples * field.vectorSize());
  return field;
}

}  // namespace

// A Walk is one thread's way through a range of samples: scratch memory, and the hits of each sample's rays.
class DirectPass::Walk {
 public:
  explicit Walk(const DirectPass& pass)
      : pass_(pass),
        look_(pass.scene_, pass.inside_test_),
        group_from_local_(glm::dmat3(1.0), pass.settings_.order),
        incident_from_local_(glm::dmat3(1.0), kIncidentOrder) {}

  // Traces the rays of sample `s`, or none if it has no face.
  std::uint32_t look(std::size_t s) {
    look_.stand(s);
    hemisphere_ = &pass_.hemisphereOf(s, look_.rayCount());
    return look_.look(hemisphere_->table(), pass_.settings_.keep_hits || !pass_.emitters_.empty());
  }

  const SampleVisibility& looked() const { return look_; }

  // Computes the transfer of the sample that was traced.
  void project(std::span<float> scalar, std::span<float> incident) {
    std::fill(scalar.begin(), scalar.end(), 0.0f);
    std::fill(incident.begin(), incident.end(), 0.0f);
    const std::size_t bands = static_cast<std::size_t>(sh::coefficientCount(pass_.settings_.order));
    local_.resize(bands);
    hemisphere_->projection().project(look_.blocked(), local_);
    group_from_local_.set(look_.frame());
    addSky(
        local_, [&](std::size_t ray) { return static_cast<float>(hemisphere_->weight(ray)); }, scalar);
    if (!incident.empty()) projectIncident(bands, incident);
    if (!pass_.emitters_.empty() && !look_.origins().empty()) {
      LambertReceiver receiver(*hemisphere_, {.scalar = scalar,
                                              .incident = incident,
                                              .channels = pass_.channels_,
                                              .columns = pass_.columns_,
                                              .first_column = static_cast<std::uint32_t>(bands)});
      const glm::mat3 frame(look_.frame());
      pass_.emitters_.addMet(look_.hits(), look_.origins(), frame, receiver);
      pass_.emitters_.addChosen(look_.origins(), frame, pass_.scene_.rays, receiver);
    }
    if (!incident.empty()) turnIncident(incident);
  }

  void keepHits(RangeHits& out) {
    hits_.clear();
    look_.keepHits(hits_);
    const std::uint32_t every = pass_.settings_.hits_of_every * (look_.rayCount() == RayCount::Twice ? 2 : 1);
    const auto weight_of = [this](std::uint32_t ray) { return hemisphere_->weight(ray); };
    out.scales.push_back(keepEvery(every, 0, hits_, weight_of, out.hits));
  }

 private:
  // Computes the environment's columns of the nine values; their outputs are still in the sample's frame.
  void projectIncident(std::size_t bands, std::span<float> incident) {
    const std::size_t stride = std::size_t{pass_.channels_} * pass_.columns_;
    incident_local_.assign(kIncident * bands, 0.0f);
    for (std::size_t ray = 0; ray < hemisphere_->table().size(); ++ray) {
      if (look_.blocked()[ray / kPacketWidth] >> (ray % kPacketWidth) & 1u) continue;
      const auto& weights = hemisphere_->incidentWeight(ray);
      const auto harmonics = hemisphere_->projection().harmonics(ray);
      for (std::size_t j = 0; j < kIncident; ++j)
        for (std::size_t i = 0; i < bands; ++i) incident_local_[j * bands + i] += weights[j] * harmonics[i];
    }
    for (std::size_t j = 0; j < kIncident; ++j)
      addSky(
          std::span(incident_local_).subspan(j * bands, bands),
          [&](std::size_t ray) { return hemisphere_->incidentWeight(ray)[j]; },
          incident.subspan(j * stride, stride));
  }

  // Fills in the environment's columns of one output from those of all open rays, in the sample's frame and
  // with these weights. Panes take a part of the light of some rays.
  template <typename WeightOf>
  void addSky(std::span<const float> open, const WeightOf& weight_of, std::span<float> out) {
    for (std::uint32_t c = 0; c < pass_.channels_; ++c) {
      const auto channel = out.subspan(c * pass_.columns_, open.size());
      if (c > 0 && look_.dimmed().empty()) {
        std::copy_n(out.begin(), open.size(), channel.begin());
        continue;
      }
      seen_.assign(open.begin(), open.end());
      for (const DimmedRay& ray : look_.dimmed()) {
        const float taken = (1.0f - ray.passed[static_cast<int>(c)]) * weight_of(ray.ray);
        const auto harmonics = hemisphere_->projection().harmonics(ray.ray);
        for (std::size_t i = 0; i < seen_.size(); ++i) seen_[i] -= taken * harmonics[i];
      }
      group_from_local_.apply(std::span<const float>(seen_), channel);
    }
  }

  // Rotates the nine outputs from the sample's frame to the group's.
  void turnIncident(std::span<float> incident) {
    incident_from_local_.set(look_.frame());
    const std::size_t stride = std::size_t{pass_.channels_} * pass_.columns_;
    std::array<float, kIncident> from, to;
    for (std::size_t at = 0; at < stride; ++at) {
      for (std::size_t j = 0; j < kIncident; ++j) from[j] = incident[j * stride + at];
      incident_from_local_.apply(std::span<const float>(from), std::span<float>(to));
      for (std::size_t j = 0; j < kIncident; ++j) incident[j * stride + at] = to[j];
    }
  }

  const DirectPass& pass_;
  SampleVisibility look_;
  sh::Rotation group_from_local_, incident_from_local_;
  const Hemisphere* hemisphere_ = nullptr;
  std::vector<float> local_, incident_local_, seen_;
  std::vector<GatherHit> hits_;
};

DirectPass::DirectPass(const TracedScene& scene, const DirectSettings& settings)
    : scene_(scene),
      settings_(settings),
      emitters_(scene.scene, scene.geometry, scene.colors, scene.lights),
      channels_(scene.colors.grey() && !settings.colored_kernels ? 1 : 3),
      columns_(static_cast<std::uint32_t>(sh::coefficientCount(settings.order)) +
               static_cast<std::uint32_t>(scene.lights.size())) {
  for (std::size_t k = 0; k < kRayCounts; ++k) {
    const std::size_t rays = raysOf(static_cast<RayCount>(k), settings.rays);
    diffuse_[k] = Hemisphere::forNormal(rays, settings.order);
    if (!scene.samples.normal_mapped.empty()) mapped_[k] = Hemisphere::forAnyNormal(rays, settings.order);
  }
}

std::uint64_t DirectPass::bake(std::size_t begin, std::size_t end, const std::stop_token& stop,
                               DirectResult& out, RangeHits& hits) const {
  Walk walk(*this);
  std::uint64_t traced = 0;
  const std::size_t first_mapped = scene_.samples.normal_mapped.begin;
  for (std::size_t s = begin; s < end && !stop.stop_requested(); ++s) {
    hits.next();
    traced += walk.look(s);
    out.looks.valid[s] = walk.looked().valid();
    out.looks.ray_counts[s] = walk.looked().rayCount();
    walk.project(out.field.at(s), s < first_mapped ? std::span<float>() : out.mapped.at(s - first_mapped));
    if (settings_.keep_hits) walk.keepHits(hits);
  }
  hits.next();
  return traced;
}

void DirectPass::paint(std::size_t first, std::span<const RayCount> ray_counts, RangeHits& hits) const {
  const auto direction = [&](std::size_t s, std::uint32_t ray) {
    const glm::mat3 frame(localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[first + s]))));
    return frame * hemisphereOf(first + s, ray_counts[s]).direction(ray);
  };
  paintHits(scene_, first, direction, hits);
}

void DirectPass::traceAgain(std::size_t begin, std::size_t end, RangeHits& hits) const {
  paint(begin, hits.traceAgain(Walk(*this), begin, end), hits);
}

std::optional<DirectResult> bakeDirect(const DirectPass& pass, const TracedScene& scene,
                                       const BakeContext& context, const char* stage) {
  const std::size_t count = scene.samples.size(), own = scene.samples.glossy.begin;
  const std::size_t first_mapped = scene.samples.normal_mapped.begin,
                    mapped = scene.samples.normal_mapped.size();
  const DirectSettings& settings = pass.settings();
  DirectResult result{.field = makeField(count, settings.order, 1, pass.channels(), pass.columns()),
                      .mapped = makeField(mapped, settings.order, kIncident, pass.channels(), pass.columns()),
                      .looks = {std::vector<std::uint8_t>(count, 0), std::vector<RayCount>(count)},
                      .hits = HitStore(own, settings.keep_hits ? settings.hit_memory : 0)};
  const auto paint = [&](std::size_t first, RangeHits& hits) {
    pass.paint(first, std::span(std::as_const(result.looks.ray_counts)).subspan(first), hits);
  };
  TracedRanges ranges(scene, own, {settings.keep_hits, context.keeps()}, paint, result.hits);
  const GreyColumns grey{.sky = scene.colors.greyPanes(), .lights = scene.colors.greyEmission()};
  const auto compute = [&](std::size_t begin, std::size_t end) {
    RangeHits hits;
    const std::uint64_t rays = pass.bake(begin, end, context.stop, result, hits);
    ranges.add(begin / kSamplesPerRange, rays, std::move(hits), context.stop);
  };
  const auto done = runStage(
      {.name = stage,
       .count = own,
       .grain = kSamplesPerRange,
       .writes = {rowsOf(result.looks.valid), rowsOf(result.looks.ray_counts), directRows(result.field, grey),
                  directRows(result.mapped, grey, -static_cast<std::ptrdiff_t>(first_mapped)),
                  ranges.output()},
       .compute = compute,
       .keep = KeepWhen::Always},
      context);
  if (!done) return std::nullopt;
  result.field.rays = ranges.raysTraced();
  result.rays_kept = ranges.raysFound();
  const auto edges = sampleEdges(scene.geometry, scene.samples);
  result.field.filled_samples = fillFromNeighbours(edges, result.looks.valid, result.field);
  fillStretchFromNeighbours(edges, result.looks.valid, first_mapped, result.mapped.vectorSize(),
                            result.mapped.vectors);
  return result;
}

}  // namespace lambent::baker
