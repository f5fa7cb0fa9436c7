#include "baker/effects/glossy/glossy_direct.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/trace/traced_samples.hpp"
#include "baker/trace/transfer_field.hpp"
#include "baker/transport/direction_table.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

// Receives l' of the lights of a group as it arrives at one sample, in even outputs and the local frame:
// values[(channel * outputs + output) * lights + light].
class GlossyReceiver : public LightReceiver {
 public:
  GlossyReceiver(const GlossyHemisphere& hemisphere, std::size_t channels, std::size_t lights,
                 std::span<float> values)
      : hemisphere_(hemisphere),
        channels_(channels),
        lights_(lights),
        values_(values),
        row_(hemisphere.evenOutputs()) {}

  glm::vec3 direction(std::size_t ray) const override { return hemisphere_.direction(ray); }
  float raysPerSteradian(float) const override { return hemisphere_.raysPerSteradian(); }
  void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) override {
    add(hemisphere_.row(ray), light, radiance);
  }
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override {
    hemisphere_.incident(local, row_);
    add(row_, light, radiance);
  }

 private:
  void add(std::span<const float> row, std::uint32_t light, glm::vec3 radiance) {
    const std::size_t outputs = hemisphere_.evenOutputs();
    for (std::size_t c = 0; c < channels_; ++c)
      for (std::size_t e = 0; e < outputs; ++e)
        values_[(c * outputs + e) * lights_ + light] += row[e] * radiance[static_cast<int>(c)];
  }

  const GlossyHemisphere& hemisphere_;
  std::size_t channels_, lights_;
  std::span<float> values_;
  std::vector<float> row_;
};

std::size_t squared(int order) {
  return static_cast<std::size_t>(sh::coefficientCount(order));
}

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

// A Walk is one thread's way through a range of samples.
class GlossyPass::Walk {
 public:
  explicit Walk(const GlossyPass& pass)
      : pass_(pass),
        look_(pass.scene_, pass.diffuse_.glances()),
        visibility_from_local_(glm::dmat3(1.0), pass.gaunt_.visibilityBands()),
        outputs_from_local_(glm::dmat3(1.0), pass.order_out_),
        local_(squared(pass.gaunt_.visibilityBands())) {}

  std::uint32_t look(std::size_t sample) {
    look_.stand(pass_.first() + sample);
    hemisphere_ = &pass_.hemisphereOf(look_.rayCount());
    return look_.look(hemisphere_->table(),
                      pass_.diffuse_.settings().keep_hits || !pass_.diffuse_.emitters().empty(),
                      BelowHorizon::Mirrored);
  }

  const SampleVisibility& looked() const { return look_; }

  void project(std::span<float> visibility) {
    hemisphere_->project(look_.blocked(), look_.dimmed(), local_);
    visibility_from_local_.set(look_.frame());
    visibility_from_local_.apply(std::span<const float>(local_), visibility);
  }

  // Fills in `values`, [channel][output][light].
  void receiveLights(std::size_t channels, std::size_t lights, std::span<float> values) {
    std::fill(values.begin(), values.end(), 0.0f);
    if (look_.origins().empty()) return;
    const std::size_t even = hemisphere_->evenOutputs();
    lights_local_.assign(channels * even * lights, 0.0f);
    GlossyReceiver receiver(*hemisphere_, channels, lights, lights_local_);
    const glm::mat3 frame(look_.frame());
    pass_.diffuse_.emitters().addMet(look_.hits(), look_.origins(), frame, receiver);
    pass_.diffuse_.emitters().addChosen(look_.origins(), frame, pass_.scene_.rays, receiver);
    outputs_from_local_.set(look_.frame());
    const std::size_t outputs = squared(pass_.order_out_);
    for (std::size_t c = 0; c < channels; ++c)
      turnOutputs(outputs_from_local_, hemisphere_->evenIndices().first(even), lights,
                  {std::span(lights_local_).subspan(c * even * lights), lights},
                  {values.subspan(c * outputs * lights), lights});
  }

  void keepHits(RangeHits& out) const { look_.keepHits(out.hits); }

 private:
  const GlossyPass& pass_;
  SampleVisibility look_;
  sh::Rotation visibility_from_local_, outputs_from_local_;
  const GlossyHemisphere* hemisphere_ = nullptr;
  std::vector<float> local_, lights_local_;
};

GlossyPass::GlossyPass(const DirectPass& plain, const TracedScene& scene, int order_out)
    : diffuse_(plain),
      scene_(scene),
      order_in_(plain.settings().order),
      order_out_(order_out),
      hemispheres_{hemisphere(RayCount::Usual), hemisphere(RayCount::Twice), hemisphere(RayCount::Few)},
      gaunt_(sh::makeGauntTable(order_in_, order_out)) {}

GlossyField GlossyPass::shape() const {
  return {.order_in = order_in_,
          .order_out = order_out_,
          .channels = diffuse_.channels(),
          .light_columns = static_cast<std::uint32_t>(scene_.lights.size()),
          .first_sample = static_cast<std::uint32_t>(first()),
          .visibility = {},
          .bounced = {},
          .lights_shadowed = {},
          .lights_full = {}};
}

std::uint64_t GlossyPass::bake(std::size_t begin, std::size_t end, const std::stop_token& stop,
                               GlossyField& field, SampleVisibilities& looks, RangeHits& hits) const {
  Walk walk(*this);
  std::uint64_t traced = 0;
  const std::size_t lights = field.light_columns, per_sample = field.channels * squared(order_out_) * lights;
  for (std::size_t s = begin; s < end && !stop.stop_requested(); ++s) {
    hits.next();
    traced += walk.look(s);
    looks.valid[first() + s] = walk.looked().valid();
    looks.ray_counts[first() + s] = walk.looked().rayCount();
    walk.project(std::span(field.visibility).subspan(s * field.visibilitySize(), field.visibilitySize()));
    if (lights > 0)
      walk.receiveLights(field.channels, lights,
                         std::span(field.lights_shadowed).subspan(s * per_sample, per_sample));
    if (diffuse_.settings().keep_hits) walk.keepHits(hits);
  }
  hits.next();
  return traced;
}

void GlossyPass::paint(std::size_t begin, std::span<const RayCount> ray_counts, RangeHits& hits) const {
  const auto direction = [&](std::size_t s, std::uint32_t ray) {
    const glm::mat3 frame(
        localFrame(glm::normalize(glm::dvec3(scene_.samples.normals[first() + begin + s]))));
    return frame * hemisphereOf(ray_counts[s]).direction(ray);
  };
  paintHits(scene_, first() + begin, direction, hits);
}

void GlossyPass::traceAgain(std::size_t begin, std::size_t end, RangeHits& hits) const {
  paint(begin, hits.traceAgain(Walk(*this), begin, end), hits);
}

void diffuseTransfer(int order_out, glm::vec3 normal, std::span<const float> matrix, std::span<float> out) {
  std::vector<float> kernel(squared(order_out));
  sh::unoccludedTransfer(order_out, normal, std::span<float>(kernel));
  std::fill(out.begin(), out.end(), 0.0f);
  for (std::size_t k = 0; k < kernel.size(); ++k)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += kernel[k] * matrix[k * out.size() + i];
}

bool diffuseFromGlossy(const GlossyPass& pass, const GlossyField& field, DirectResult& direct,
                       const std::stop_token& stop) {
  const std::size_t outputs = squared(field.order_out), columns = squared(field.order_in),
                    lights = field.light_columns;
  return parallelRanges(pass.size(), kSamplesPerRange, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<float> matrix(outputs * columns);
    for (std::size_t s = begin; s < end; ++s) {
      std::fill(matrix.begin(), matrix.end(), 0.0f);
      sh::addVisibilityMatrix(
          pass.gaunt(),
          std::span(field.visibility).subspan(s * field.visibilitySize(), field.visibilitySize()), matrix);
      const glm::vec3 normal = pass.scene().samples.normals[pass.first() + s];
      const auto out = direct.field.at(pass.first() + s);
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

std::optional<GlossyDirect> bakeGlossyDirect(const GlossyPass& pass, std::size_t hit_memory,
                                             SampleVisibilities& looks, const BakeContext& context,
                                             const char* stage) {
  const SampleSet& samples = pass.scene().samples;
  const std::size_t count = pass.size();
  const bool keep_hits = pass.plain().settings().keep_hits;
  GlossyDirect result{.field = pass.shape(), .hits = HitStore(count, keep_hits ? hit_memory : 0)};
  GlossyField& field = result.field;
  // For grey lamps the first channel stands for all (transfer_field.hpp).
  const std::size_t lights = field.light_columns, channel = squared(field.order_out) * lights,
                    per_sample = field.channels * channel,
                    kept_lights = pass.scene().colors.greyEmission() ? channel : per_sample;
  field.visibility.resize(count * field.visibilitySize());
  field.lights_shadowed.resize(count * per_sample);
  const auto paint = [&](std::size_t begin, RangeHits& hits) {
    pass.paint(begin, std::span(std::as_const(looks.ray_counts)).subspan(pass.first() + begin), hits);
  };
  TracedRanges ranges(pass.scene(), count, {keep_hits, context.keeps()}, paint, result.hits);
  const auto compute = [&](std::size_t begin, std::size_t end) {
    RangeHits hits;
    const std::uint64_t rays = pass.bake(begin, end, context.stop, field, looks, hits);
    ranges.add(begin / kSamplesPerRange, rays, std::move(hits), context.stop);
  };
  const auto first = static_cast<std::ptrdiff_t>(pass.first());
  const auto done =
      runStage({.name = stage,
                .count = count,
                .grain = kSamplesPerRange,
                .writes = {rowsOf(looks.valid, 1, first), rowsOf(looks.ray_counts, 1, first),
                           rowsOf(field.visibility, field.visibilitySize()),
                           repeatingRows(field.lights_shadowed, per_sample, kept_lights), ranges.output()},
                .compute = compute,
                .keep = KeepWhen::Always},
               context);
  if (!done) return std::nullopt;
  result.rays = ranges.raysTraced();
  result.rays_kept = ranges.raysFound();
  const auto first_valid = looks.valid.begin() + first;
  if (std::find(first_valid, looks.valid.end(), std::uint8_t{0}) != looks.valid.end()) {
    const auto edges = sampleEdges(pass.scene().geometry, samples);
    const auto fill = [&](std::size_t size, std::vector<float>& values) {
      return fillStretchFromNeighbours(edges, looks.valid, pass.first(), size, values);
    };
    result.filled_samples = fill(field.visibilitySize(), field.visibility);
    if (lights > 0) fill(per_sample, field.lights_shadowed);
  }
  return result;
}

}  // namespace lambent::baker
