#include "baker/effects/surface/direct.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

constexpr int kIncidentOrder = 3;

// Receives the light of a group's lights at one sample, in the outputs of its hemisphere and its own frame:
// values[(channel * outputs + output) * lights + light].
class Receiver : public LightReceiver {
 public:
  Receiver(const Hemisphere& hemisphere, std::size_t channels, std::size_t lights, std::span<float> values)
      : hemisphere_(hemisphere),
        channels_(channels),
        lights_(lights),
        values_(values),
        row_(hemisphere.outputs()) {}

  glm::vec3 direction(std::size_t ray) const override { return hemisphere_.direction(ray); }
  float raysPerSteradian(float cosine) const override { return hemisphere_.raysPerSteradian(cosine); }
  void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) override {
    add(hemisphere_.row(ray), light, radiance);
  }
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override {
    hemisphere_.incident(local, row_);
    add(row_, light, radiance);
  }

 private:
  void add(std::span<const float> row, std::uint32_t light, glm::vec3 radiance) {
    for (std::size_t c = 0; c < channels_; ++c)
      for (std::size_t o = 0; o < row.size(); ++o)
        values_[(c * row.size() + o) * lights_ + light] += row[o] * radiance[static_cast<int>(c)];
  }

  const Hemisphere& hemisphere_;
  std::size_t channels_, lights_;
  std::span<float> values_;
  std::vector<float> row_;
};

// Returns an output with rows of `width` values, of which only the first `kept` are stored, since the others
// repeat them.
Output repeatingRows(std::vector<float>& values, std::size_t width, std::size_t kept) {
  return {[&values, width, kept](std::size_t begin, std::size_t end, ByteWriter& out) {
            for (std::size_t s = begin; s < end; ++s)
              out.addList(std::span<const float>(values).subspan(s * width, kept));
          },
          [&values, width, kept](std::size_t begin, std::size_t end, ByteReader& in) {
            for (std::size_t s = begin; s < end; ++s) {
              const auto row = std::span(values).subspan(s * width, width);
              if (!in.readInto(row.first(kept))) return false;
              for (std::size_t i = kept; i < width; ++i) row[i] = row[i - kept];
            }
            return true;
          }};
}

}  // namespace

// A Walk is one thread's way through a range of samples: scratch memory, and the hits of each sample's rays.
class DirectPass::Walk {
 public:
  explicit Walk(const DirectPass& pass)
      : pass_(pass),
        samples_(pass.scene_.samples),
        look_(pass.scene_, pass.inside_test_),
        lights_(pass.scene_.lights.size()),
        sky_from_local_(glm::dmat3(1.0), pass.settings_.order),
        incident_from_local_(glm::dmat3(1.0), kIncidentOrder),
        visibility_from_local_(glm::dmat3(1.0), pass.gaunt_ ? pass.gaunt_->visibilityBands() : 1),
        outputs_from_local_(glm::dmat3(1.0), pass.settings_.order_out) {}

  // Traces the rays of sample `s`, or none if it has no face.
  std::uint32_t look(std::size_t s) {
    sample_ = s;
    look_.stand(s);
    hemisphere_ = &pass_.hemisphereOf(s, look_.rayCount());
    return look_.look(hemisphere_->table(), pass_.settings_.keep_hits || !pass_.emitters_.empty(),
                      glossy() ? BelowHorizon::Mirrored : BelowHorizon::Blocked);
  }

  const SampleVisibility& looked() const { return look_; }

  // Computes the transfer of the sample that was traced.
  void project(DirectResult& out) {
    receiveLights();
    if (glossy()) return projectGlossy(sample_ - samples_.glossy.begin, out.glossy);
    const auto scalar = out.field.at(sample_);
    std::fill(scalar.begin(), scalar.end(), 0.0f);
    const std::size_t bands = squared(pass_.settings_.order);
    local_.resize(bands);
    hemisphere_->projection().project(look_.blocked(), local_);
    sky_from_local_.set(look_.frame());
    addSky(local_, /*output=*/0, scalar);
    placeLights(/*output=*/0, scalar);
    if (sample_ >= samples_.normal_mapped.begin)
      projectMapped(bands, out.mapped.at(sample_ - samples_.normal_mapped.begin));
  }

  void keepHits(RangeHits& out) {
    if (glossy()) return look_.keepHits(out.hits);
    hits_.clear();
    look_.keepHits(hits_);
    const std::uint32_t every = pass_.settings_.hits_of_every * (look_.rayCount() == RayCount::Twice ? 2 : 1);
    const auto weight_of = [this](std::uint32_t ray) { return hemisphere_->weight(ray); };
    out.scales.push_back(keepEvery(every, 0, hits_, weight_of, out.hits));
  }

 private:
  bool glossy() const { return sample_ >= samples_.glossy.begin; }

  // Fills lights_local_ with what arrives from the group's lights.
  void receiveLights() {
    lights_local_.assign(pass_.channels_ * hemisphere_->outputs() * lights_, 0.0f);
    if (pass_.emitters_.empty() || look_.origins().empty()) return;
    Receiver receiver(*hemisphere_, pass_.channels_, lights_, lights_local_);
    const glm::mat3 frame(look_.frame());
    pass_.emitters_.addMet(look_.hits(), look_.origins(), frame, receiver);
    pass_.emitters_.addChosen(look_.origins(), frame, pass_.scene_.rays, receiver);
  }
  // Puts one output of it, local or turned already, into the last columns of each channel.
  void placeLights(std::size_t output, std::span<float> out) const {
    for (std::size_t c = 0; c < pass_.channels_; ++c)
      std::copy_n(lights_local_.begin() +
                      static_cast<std::ptrdiff_t>((c * hemisphere_->outputs() + output) * lights_),
                  lights_, out.begin() + static_cast<std::ptrdiff_t>((c + 1) * pass_.columns_ - lights_));
  }

  void projectGlossy(std::size_t s, GlossyField& out) {
    local_.resize(out.visibilitySize());
    hemisphere_->projectVisibility(look_.blocked(), look_.dimmed(), local_);
    visibility_from_local_.set(look_.frame());
    visibility_from_local_.apply(
        std::span<const float>(local_),
        std::span(out.visibility).subspan(s * out.visibilitySize(), out.visibilitySize()));
    if (lights_ == 0 || look_.origins().empty()) return;
    outputs_from_local_.set(look_.frame());
    const std::size_t own = hemisphere_->outputs() * lights_, whole = squared(out.order_out) * lights_;
    for (std::size_t c = 0; c < out.channels; ++c)
      hemisphere_->turn(
          outputs_from_local_, lights_, {std::span<const float>(lights_local_).subspan(c * own), lights_},
          {std::span(out.lights_shadowed).subspan((s * out.channels + c) * whole, whole), lights_});
  }

  // Computes the nine values, in the sample's frame at first.
  void projectMapped(std::size_t bands, std::span<float> incident) {
    const std::size_t stride = std::size_t{pass_.channels_} * pass_.columns_;
    std::fill(incident.begin(), incident.end(), 0.0f);
    incident_local_.assign(kIncident * bands, 0.0f);
    for (std::size_t ray = 0; ray < hemisphere_->table().size(); ++ray) {
      if (look_.blocked()[ray / kPacketWidth] >> (ray % kPacketWidth) & 1u) continue;
      const auto weights = hemisphere_->row(ray).last(kIncident);
      const auto harmonics = hemisphere_->projection().harmonics(ray);
      for (std::size_t j = 0; j < kIncident; ++j)
        for (std::size_t i = 0; i < bands; ++i) incident_local_[j * bands + i] += weights[j] * harmonics[i];
    }
    for (std::size_t j = 0; j < kIncident; ++j) {
      const auto own = incident.subspan(j * stride, stride);
      addSky(std::span(incident_local_).subspan(j * bands, bands), 1 + j, own);
      placeLights(1 + j, own);
    }
    incident_from_local_.set(look_.frame());
    hemisphere_->turn(incident_from_local_, stride, {incident, stride}, {incident, stride});
  }

  // Fills in the environment's columns of one output from those of all open rays, in the sample's frame.
  // Panes take a part of the light of some rays.
  void addSky(std::span<const float> open, std::size_t output, std::span<float> out) {
    for (std::uint32_t c = 0; c < pass_.channels_; ++c) {
      const auto channel = out.subspan(c * pass_.columns_, open.size());
      if (c > 0 && look_.dimmed().empty()) {
        std::copy_n(out.begin(), open.size(), channel.begin());
        continue;
      }
      seen_.assign(open.begin(), open.end());
      for (const DimmedRay& ray : look_.dimmed()) {
        const float taken = (1.0f - ray.passed[static_cast<int>(c)]) * hemisphere_->row(ray.ray)[output];
        const auto harmonics = hemisphere_->projection().harmonics(ray.ray);
        for (std::size_t i = 0; i < seen_.size(); ++i) seen_[i] -= taken * harmonics[i];
      }
      sky_from_local_.apply(std::span<const float>(seen_), channel);
    }
  }

  const DirectPass& pass_;
  const SampleSet& samples_;
  SampleVisibility look_;
  std::size_t lights_, sample_ = 0;
  sh::Rotation sky_from_local_, incident_from_local_, visibility_from_local_, outputs_from_local_;
  const Hemisphere* hemisphere_ = nullptr;
  std::vector<float> local_, lights_local_, incident_local_, seen_;
  std::vector<GatherHit> hits_;
};

const Hemisphere& DirectPass::hemisphereOf(std::size_t sample, RayCount count) const {
  const SampleSet& samples = scene_.samples;
  const std::size_t kind = (sample >= samples.normal_mapped.begin) + (sample >= samples.glossy.begin);
  return *hemispheres_[kind][static_cast<std::size_t>(count)];
}

DirectPass::DirectPass(const TracedScene& scene, const DirectSettings& settings)
    : scene_(scene),
      settings_(settings),
      emitters_(scene.scene, scene.geometry, scene.colors, scene.lights),
      channels_(scene.colors.grey() && !settings.colored_kernels ? 1 : 3),
      columns_(static_cast<std::uint32_t>(squared(settings.order) + scene.lights.size())) {
  const SampleSet& samples = scene.samples;
  if (!samples.glossy.empty()) gaunt_ = sh::makeGauntTable(settings.order, settings.order_out);
  for (std::size_t k = 0; k < kRayCounts; ++k) {
    const std::size_t rays = raysOf(static_cast<RayCount>(k), settings.rays);
    if (!samples.diffuse.empty()) hemispheres_[0][k] = Hemisphere::forNormal(rays, settings.order);
    if (!samples.normal_mapped.empty()) hemispheres_[1][k] = Hemisphere::forAnyNormal(rays, settings.order);
    if (!samples.glossy.empty())
      hemispheres_[2][k] = Hemisphere::forBrdfs(rays, gaunt_->visibilityBands(), settings.order_out);
  }
}

DirectResult DirectPass::untraced() const {
  const SampleSet& samples = scene_.samples;
  const auto fieldOf = [&](std::size_t count, std::uint32_t outputs) {
    return TransferField{.order = settings_.order,
                         .outputs = outputs,
                         .channels = channels_,
                         .columns = columns_,
                         .vectors = {}}
        .zeros(count);
  };
  DirectResult out{
      .field = fieldOf(samples.size(), 1),
      .mapped = fieldOf(samples.normal_mapped.size(), kIncident),
      .glossy = {.order_in = settings_.order,
                 .order_out = settings_.order_out,
                 .channels = channels_,
                 .light_columns = static_cast<std::uint32_t>(scene_.lights.size()),
                 .first_sample = static_cast<std::uint32_t>(samples.glossy.begin),
                 .visibility = {},
                 .bounced = {},
                 .lights_shadowed = {},
                 .lights_full = {}},
      .looks = {std::vector<std::uint8_t>(samples.size(), 0), std::vector<RayCount>(samples.size())},
      .parts = {}};
  GlossyField& glossy = out.glossy;
  glossy.visibility.resize(samples.glossy.size() * glossy.visibilitySize());
  glossy.lights_shadowed.resize(samples.glossy.size() * channels_ * squared(glossy.order_out) *
                                glossy.light_columns);
  return out;
}

std::uint64_t DirectPass::bake(std::size_t begin, std::size_t end, const std::stop_token& stop,
                               DirectResult& out, RangeHits& hits) const {
  Walk walk(*this);
  std::uint64_t traced = 0;
  for (std::size_t s = begin; s < end && !stop.stop_requested(); ++s) {
    hits.next();
    traced += walk.look(s);
    out.looks.valid[s] = walk.looked().valid();
    out.looks.ray_counts[s] = walk.looked().rayCount();
    walk.project(out);
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
  Walk walk(*this);
  std::vector<RayCount> ray_counts;
  hits.offsets.clear();
  hits.hits.clear();
  hits.scales.clear();
  for (std::size_t s = begin; s < end; ++s) {
    hits.next();
    walk.look(s);
    walk.keepHits(hits);
    ray_counts.push_back(walk.looked().rayCount());
  }
  hits.next();
  paint(begin, ray_counts, hits);
}

namespace {

// Holds what ranges of samples traced as an output of the stage that traces: the numbers of rays, and their
// hits. The store gets hits with colours; the output keeps them without, so that traced results stay valid
// when colours change.
class TracedRanges {
 public:
  // `kept` says that output() will be written. Everything must outlive this.
  TracedRanges(const DirectPass& pass, std::size_t samples, bool kept, const SampleVisibilities& looks,
               HitStore& store)
      : pass_(pass),
        kept_(kept),
        looks_(looks),
        store_(store),
        rays_((samples + kSamplesPerRange - 1) / kSamplesPerRange, 0),
        unpainted_(rays_.size()) {}

  // Takes the result of a range that was traced just now. May be called from any thread, once for each range.
  // If a stop was requested, the hits are not kept.
  void add(std::size_t range, std::uint64_t rays, RangeHits&& hits, const std::stop_token& stop) {
    rays_[range] = rays;
    traced_ += rays;
    if (!pass_.settings().keep_hits || stop.stop_requested()) return;
    if (kept_) {
      ByteWriter bytes;
      writeHits(hits, bytes);
      unpainted_[range] = bytes.take();
    }
    offer(range, std::move(hits));
  }

  // Returns an output for a stage with ranges of kSamplesPerRange, after those of SampleVisibilities. It must
  // not outlive this.
  Output output() {
    return {[this](std::size_t begin, std::size_t, ByteWriter& out) {
              const std::size_t range = begin / kSamplesPerRange;
              out.add(rays_[range]);
              // Hits that had no room in memory are not written; they are traced again when they are asked
              // for.
              const bool with_hits = pass_.settings().keep_hits && store_.range(range).kept;
              out.add(with_hits);
              const std::vector<std::byte> hits = std::exchange(unpainted_[range], {});
              if (with_hits) out.addBytes(hits);
            },
            [this](std::size_t begin, std::size_t end, ByteReader& in) {
              const std::size_t range = begin / kSamplesPerRange,
                                triangles = pass_.scene().geometry.triangles.size();
              bool with_hits = false;
              RangeHits hits;
              if (!in.read(rays_[range]) || !in.read(with_hits) ||
                  (with_hits && !readHits(in, end - begin, triangles, hits)))
                return false;
              if (with_hits) offer(range, std::move(hits));
              return true;
            }};
  }

  // May be called once all ranges are there.
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysFound() const {
    return std::accumulate(rays_.begin(), rays_.end(), std::uint64_t{0}) - traced_;
  }

 private:
  void offer(std::size_t range, RangeHits&& hits) {
    const std::size_t first = store_.first() + range * kSamplesPerRange;
    pass_.paint(first, std::span(looks_.ray_counts).subspan(first), hits);
    store_.offer(range, std::move(hits));
  }

  const DirectPass& pass_;
  bool kept_;
  const SampleVisibilities& looks_;
  HitStore& store_;
  std::vector<std::uint64_t> rays_;
  std::vector<std::vector<std::byte>> unpainted_;  // packed hits without colours, until they are written
  std::atomic<std::uint64_t> traced_ = 0;
};

}  // namespace

bool traceDirect(const DirectPass& pass, SurfacePart part, const BakeContext& context, const char* stage,
                 DirectResult& out) {
  const TracedScene& scene = pass.scene();
  const SampleSet& samples = scene.samples;
  const DirectSettings& settings = pass.settings();
  const SampleStretch stretch = stretchOf(samples, part);
  const auto first = static_cast<std::ptrdiff_t>(stretch.begin);
  TracedPart& traced = out.of(part);
  traced.hits = HitStore(stretch.size(), settings.keep_hits ? settings.hit_memory : 0, stretch.begin);
  TracedRanges ranges(pass, stretch.size(), context.keeps(), out.looks, traced.hits);
  const auto compute = [&](std::size_t begin, std::size_t end) {
    RangeHits hits;
    const std::uint64_t rays = pass.bake(stretch.begin + begin, stretch.begin + end, context.stop, out, hits);
    ranges.add(begin / kSamplesPerRange, rays, std::move(hits), context.stop);
  };
  std::vector<Output> writes = {rowsOf(out.looks.valid, 1, first), rowsOf(out.looks.ray_counts, 1, first)};
  GlossyField& glossy = out.glossy;
  const std::size_t channel = squared(glossy.order_out) * glossy.light_columns,
                    lights = glossy.channels * channel;
  const bool grey_lights = scene.colors.greyEmission();
  if (part == SurfacePart::Glossy) {
    writes.push_back(rowsOf(glossy.visibility, glossy.visibilitySize()));
    // For grey lamps the first channel stands for all (transfer_field.hpp).
    writes.push_back(repeatingRows(glossy.lights_shadowed, lights, grey_lights ? channel : lights));
  } else {
    const GreyColumns grey{.sky = scene.colors.greyPanes(), .lights = grey_lights};
    writes.push_back(directRows(out.field, grey));
    writes.push_back(directRows(out.mapped, grey, -static_cast<std::ptrdiff_t>(samples.normal_mapped.begin)));
  }
  writes.push_back(ranges.output());
  if (!runStage({.name = stage,
                 .count = stretch.size(),
                 .grain = kSamplesPerRange,
                 .writes = std::move(writes),
                 .compute = compute,
                 .keep = KeepWhen::Always},
                context))
    return false;
  traced.rays = ranges.raysTraced();
  traced.rays_kept = ranges.raysFound();
  const auto own_valid = std::span(out.looks.valid).subspan(stretch.begin, stretch.size());
  if (std::ranges::find(own_valid, std::uint8_t{0}) == own_valid.end()) return true;
  const auto edges = sampleEdges(scene.geometry, samples);
  const auto fill = [&](std::size_t begin, std::size_t size, std::vector<float>& values) {
    return fillFromNeighbours(edges, out.looks.valid, begin, size, values);
  };
  if (part == SurfacePart::Glossy) {
    traced.filled_samples = fill(stretch.begin, glossy.visibilitySize(), glossy.visibility);
    if (lights > 0) fill(stretch.begin, lights, glossy.lights_shadowed);
  } else {
    traced.filled_samples = fill(0, out.field.vectorSize(), out.field.vectors);
    fill(samples.normal_mapped.begin, out.mapped.vectorSize(), out.mapped.vectors);
  }
  return true;
}

bool traceDirect(const DirectPass& pass, const BakeContext& context, const char* stage, DirectResult& out) {
  const SampleSet& samples = pass.scene().samples;
  const bool matte = stretchOf(samples, SurfacePart::Matte).empty() ||
                     traceDirect(pass, SurfacePart::Matte, context, stage, out);
  return matte && (samples.glossy.empty() ||
                   traceDirect(pass, SurfacePart::Glossy, context.part("glossy"), stage, out));
}

std::optional<DirectResult> bakeDirect(const DirectPass& pass, const BakeContext& context) {
  DirectResult out = pass.untraced();
  if (!traceDirect(pass, context, "direct light", out) || !diffuseFromGlossy(pass, out, context.stop))
    return std::nullopt;
  return out;
}

void diffuseTransfer(int order_out, glm::vec3 normal, std::span<const float> matrix, std::span<float> out) {
  std::vector<float> kernel(squared(order_out));
  sh::unoccludedTransfer(order_out, normal, std::span<float>(kernel));
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t k = 0; k < kernel.size(); ++k)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += kernel[k] * matrix[k * out.size() + i];
}

bool diffuseFromGlossy(const DirectPass& pass, DirectResult& direct, const std::stop_token& stop) {
  const GlossyField& field = direct.glossy;
  const std::size_t outputs = squared(field.order_out), columns = squared(field.order_in),
                    lights = field.light_columns;
  return parallelRanges(field.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<float> matrix(outputs * columns);
    for (std::size_t s = begin; s < end; ++s) {
      std::fill(matrix.begin(), matrix.end(), 0.0f);
      sh::addVisibilityMatrix(pass.gaunt(), field.visibilityOf(s), matrix);
      const std::size_t sample = field.first_sample + s;
      const glm::vec3 normal = pass.scene().samples.normals[sample];
      const auto out = direct.field.at(sample);
      diffuseTransfer(field.order_out, normal, matrix, out.first(columns));
      for (std::size_t c = 0; c < field.channels; ++c) {
        std::copy_n(out.begin(), columns,
                    out.begin() + static_cast<std::ptrdiff_t>(c * direct.field.columns));
        if (lights > 0)
          diffuseTransfer(field.order_out, normal,
                          std::span(field.lights_shadowed)
                              .subspan((s * field.channels + c) * outputs * lights, outputs * lights),
                          out.subspan(c * direct.field.columns + columns, lights));
      }
    }
  });
}

}  // namespace lambent::baker
