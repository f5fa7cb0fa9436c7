#include "baker/bake/picture_error.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "baker/bake/picture_sums.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Points are looked at by so many times the rays of vertices, within these limits, but always by more. Glossy
// ones have only kLeastTimes as many, since light between glossy surfaces is dear to gather; the noise of
// both is known and taken off.
constexpr std::size_t kTimesFewRays = 8, kLeastManyRays = 1024, kMostManyRays = 4096, kLeastTimes = 2;

// Adds `weight` times the environment's part of a sample's vector to all channels of `out`.
void addWeighted(const TransferField& field, std::size_t sample, float weight, std::span<float> out) {
  const auto from = field.at(sample);
  const std::size_t size = out.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t row = (field.channels == 3 ? c : 0) * field.columns;
    for (std::size_t i = 0; i < size; ++i) out[c * size + i] += weight * from[row + i];
  }
}

// Holds what codes say of the samples that are asked for.
using Decoded = std::unordered_map<std::uint32_t, std::vector<float>>;

// Calls take(sample, its vector) for the samples of a cell that `decoded` names.
template <typename Take>
void decodeCell(const SampleCell& cell, const CodedTransfer& coded, Decoded& decoded, const Take& take) {
  const std::vector<float> vectors = decodeTransfer(coded);
  for (auto& [sample, out] : decoded)
    if (sample >= cell.first && sample < cell.first + cell.count)
      take(std::span(vectors).subspan((sample - cell.first) * coded.shape.size(), coded.shape.size()), out);
}

double noiseOfMany(std::size_t few, std::size_t many) {
  return static_cast<double>(few) / static_cast<double>(few + many);
}

// The points of diffuse surfaces: light that leaves them is albedo times transfer of E/pi.
class DiffusePoints {
 public:
  DiffusePoints(const TracedView& traced, const TracedScene& scene, const BakedVertices& baked)
      : points_(traced.view.diffuse), traced_(traced), scene_(scene), baked_(baked) {}

  void addTo(PictureSums& sums) {
    decode();
    const auto& noisy = traced_.noisy->direct();
    const auto& exact = traced_.exact->direct();
    const double noise_of_exact =
        noiseOfMany(traced_.noisy->pass().settings().rays, traced_.exact->pass().settings().rays);
    const std::size_t size = 3 * sums.coefficients();
    std::vector<float> many(size), few(size), fields(size), codes(size);
    for (std::size_t p = 0; p < points_.eyes.size(); ++p) {
      if (!seen(p)) continue;
      for (auto* vector : {&many, &few, &fields, &codes}) std::fill(vector->begin(), vector->end(), 0.0f);
      addWeighted(noisy.field, p, 1.0f, few);
      addWeighted(exact.field, p, 1.0f, many);
      if (!baked_.bounced_at_points.empty()) {
        addWeighted(baked_.bounced_at_points[0], p, 1.0f, few);
        addWeighted(baked_.bounced_at_points[1], p, 1.0f, many);
      }
      PictureSums::Point point{
          .eye = points_.eyes[p], .squared_shares = 0.0, .noise_of_exact = noise_of_exact};
      for (const auto& [sample, weight] : shownAt(p)) {
        point.squared_shares += double{weight} * double{weight};
        addWeighted(baked_.direct, sample, weight, fields);
        if (baked_.bounced) addWeighted(*baked_.bounced, sample, weight, fields);
        if (!baked_.cells) continue;
        const std::vector<float>& of_codes = decoded_.at(sample);
        for (std::size_t i = 0; i < size; ++i) codes[i] += weight * of_codes[i];
      }
      if (!baked_.cells) codes = fields;
      const glm::vec3 albedo =
          scene_.colors.albedo(points_.points.triangles[p], points_.weights[p].y, points_.weights[p].z);
      for (auto* vector : {&many, &few, &fields, &codes})
        for (std::size_t i = 0; i < size; ++i)
          (*vector)[i] *= albedo[static_cast<int>(i / sums.coefficients())];
      sums.add(point, {.exact = many, .noisy = few, .fields = fields, .codes = codes});
    }
  }

 private:
  std::array<SampleShare, 4> shownAt(std::size_t p) const {
    return shownSamples(scene_.geometry, scene_.samples, points_.points.triangles[p], points_.weights[p]);
  }
  bool seen(std::size_t p) const {
    return traced_.noisy->direct().looks.valid[p] != 0 && traced_.exact->direct().looks.valid[p] != 0;
  }
  void decode() {
    if (!baked_.cells) return;
    for (std::size_t p = 0; p < points_.eyes.size(); ++p)
      if (seen(p))
        for (const SampleShare& shown : shownAt(p)) decoded_[shown.sample];
    for (std::size_t c = 0; c < scene_.samples.cells.size(); ++c) {
      const SampleCell& cell = scene_.samples.cells[c];
      if (cell.kind != SampleKind::Diffuse) continue;
      const CodedTransfer& coded = (*baked_.cells)[c].front();
      const std::size_t size = coded.shape.columns(), shadowed = coded.shape.shadowed_channels * size;
      const std::uint32_t full = coded.shape.full_channels;
      const std::uint32_t channels = full > 0 ? full : coded.shape.shadowed_channels;
      decodeCell(cell, coded, decoded_, [&](std::span<const float> vector, std::vector<float>& out) {
        const auto from = vector.subspan(full > 0 ? shadowed : 0);
        out.resize(3 * size);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = from[channels == 3 ? i : i % size];
      });
    }
  }

  const ViewPoints& points_;
  const TracedView& traced_;
  const TracedScene& scene_;
  const BakedVertices& baked_;
  Decoded decoded_;  // three channels of E/pi, with all bounces
};

// The points of glossy surfaces: light that leaves them towards the eye is the dot product of the exit kernel
// (surface_brdfs.hpp) with the light that matrices transfer there, direct and bounced.
class GlossyPoints {
 public:
  GlossyPoints(const TracedView& traced, const TracedScene& scene, const BakedVertices& baked)
      : points_(traced.view.glossy),
        traced_(traced),
        scene_(scene),
        baked_(baked),
        outputs_(static_cast<std::size_t>(sh::coefficientCount(baked.glossy->order_out))),
        columns_(static_cast<std::size_t>(sh::coefficientCount(baked.glossy->order_in))),
        kernel_(3 * outputs_),
        matrix_(outputs_ * columns_) {}

  void addTo(PictureSums& sums) {
    decode();
    const GlossyField &noisy = traced_.noisy_glossy->direct().field,
                      &exact = traced_.exact_glossy->direct().field;
    const double noise_of_exact = noiseOfMany(traced_.noisy_glossy->pass().plain().settings().rays,
                                              traced_.exact_glossy->pass().plain().settings().rays);
    const std::size_t size = baked_.glossy->visibilitySize() + bouncedSize();
    std::vector<float> transfer(size), of_codes(size);
    std::vector<float> many(3 * columns_), few(many), fields(many), codes(many);
    for (std::size_t p = 0; p < points_.eyes.size(); ++p) {
      if (!seen(p)) continue;
      const std::uint32_t triangle = points_.points.triangles[p];
      const glm::vec3& weights = points_.weights[p];
      baked_.brdfs->exitKernel(triangle, weights.y, weights.z, points_.to_eyes[p], kernel_);
      const auto leaves = [&](const GlossyField& field, std::vector<float>& out) {
        std::fill(transfer.begin(), transfer.end(), 0.0f);
        addSample(field, p, 1.0f, transfer);
        exit(transfer, out);
      };
      leaves(noisy, few);
      leaves(exact, many);
      std::fill(transfer.begin(), transfer.end(), 0.0f);
      std::fill(of_codes.begin(), of_codes.end(), 0.0f);
      PictureSums::Point point{.eye = points_.eyes[p],
                               .weight = static_cast<double>(points_.stands_for),
                               .squared_shares = 0.0,
                               .noise_of_exact = noise_of_exact};
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t sample = sampleOf(p, corner);
        point.squared_shares += double{weights[corner]} * double{weights[corner]};
        addSample(*baked_.glossy, sample - baked_.glossy->first_sample, weights[corner], transfer);
        if (!baked_.cells) continue;
        const std::vector<float>& decoded = decoded_.at(sample);
        for (std::size_t i = 0; i < size; ++i) of_codes[i] += weights[corner] * decoded[i];
      }
      exit(transfer, fields);
      if (baked_.cells) exit(of_codes, codes);
      sums.add(point,
               {.exact = many, .noisy = few, .fields = fields, .codes = baked_.cells ? codes : fields});
    }
  }

 private:
  std::size_t bouncedSize() const {
    return baked_.glossy->bounced.empty() ? 0 : baked_.glossy->channels * outputs_ * columns_;
  }
  bool seen(std::size_t p) const {
    return traced_.noisy_glossy->looks().valid[p] != 0 && traced_.exact_glossy->looks().valid[p] != 0;
  }
  std::uint32_t sampleOf(std::size_t p, int corner) const {
    return scene_.samples.vertex_sample[scene_.geometry.triangles[points_.points.triangles[p]][corner]];
  }
  // Adds a sample's visibility, and then its bounced light.
  void addSample(const GlossyField& field, std::size_t sample, float weight, std::span<float> out) const {
    const std::size_t visibility = field.visibilitySize(), bounced = bouncedSize();
    for (std::size_t i = 0; i < visibility; ++i) out[i] += weight * field.visibility[sample * visibility + i];
    for (std::size_t i = 0; i < bounced; ++i)
      out[visibility + i] += weight * field.bounced[sample * bounced + i];
  }
  // Computes the radiance that leaves by kernel_ where `transfer` is visibility and bounced light.
  void exit(std::span<const float> transfer, std::span<float> out) {
    const auto visibility = transfer.first(baked_.glossy->visibilitySize());
    const auto bounced = transfer.subspan(visibility.size());
    std::fill(matrix_.begin(), matrix_.end(), 0.0f);
    sh::addVisibilityMatrix(traced_.exact_glossy->pass().gaunt(), visibility, matrix_);
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t first = baked_.glossy->channels == 3 ? c * matrix_.size() : 0;
      for (std::size_t k = 0, at = 0; k < outputs_; ++k)
        for (std::size_t i = 0; i < columns_; ++i, ++at)
          out[c * columns_ + i] +=
              kernel_[c * outputs_ + k] * (bounced.empty() ? matrix_[at] : matrix_[at] + bounced[first + at]);
    }
  }
  void decode() {
    if (!baked_.cells) return;
    for (std::size_t p = 0; p < points_.eyes.size(); ++p)
      for (int corner = 0; corner < 3 && seen(p); ++corner)
        decoded_[sampleOf(p, corner)].resize(baked_.glossy->visibilitySize() + bouncedSize());
    for (std::size_t c = 0; c < scene_.samples.cells.size(); ++c) {
      const SampleCell& cell = scene_.samples.cells[c];
      if (cell.kind != SampleKind::Glossy) continue;
      for (const CodedTransfer& coded : (*baked_.cells)[c]) {
        if (coded.shape.order == 0) continue;  // light of the group's lamps
        const std::size_t first = coded.shape.isVisibility() ? 0 : baked_.glossy->visibilitySize();
        decodeCell(cell, coded, decoded_, [&](std::span<const float> vector, std::vector<float>& out) {
          std::copy(vector.begin(), vector.end(), out.begin() + static_cast<std::ptrdiff_t>(first));
        });
      }
    }
  }

  const ViewPoints& points_;
  const TracedView& traced_;
  const TracedScene& scene_;
  const BakedVertices& baked_;
  std::size_t outputs_, columns_;
  std::vector<float> kernel_, matrix_;
  Decoded decoded_;  // visibility, and then bounced light
};

}  // namespace

std::optional<TracedView> traceView(const DirectPass& vertices, int glossy_order, const TracedScene& scene,
                                    const BakeContext& context) {
  TracedView traced{viewPoints(scene), nullptr, nullptr, nullptr, nullptr};
  const BakeContext unkept = context.keyed(Key{});
  const char* const stage = "error of pictures";
  const std::size_t few = vertices.settings().rays, twice = kLeastTimes * few;
  const auto trace = [&](std::size_t rays) {
    DirectSettings settings = vertices.settings();
    settings.rays = rays;
    auto points = std::make_shared<TracedPoints>(scene, traced.view.diffuse.points, settings);
    return points->look(unkept, stage) ? points : nullptr;
  };
  const auto trace_glossy = [&](std::size_t rays) {
    DirectSettings settings = vertices.settings();
    settings.rays = rays;
    auto points =
        std::make_shared<TracedGlossyPoints>(scene, traced.view.glossy.points, settings, glossy_order);
    return points->look(settings.hit_memory, unkept, stage) ? points : nullptr;
  };
  if (!scene.samples.diffuse.empty()) {
    traced.noisy = trace(few);
    traced.exact = trace(std::max(twice, std::clamp(kTimesFewRays * few, kLeastManyRays, kMostManyRays)));
    if (!traced.noisy || !traced.exact) return std::nullopt;
  }
  if (!scene.samples.glossy.empty()) {
    traced.noisy_glossy = trace_glossy(few);
    traced.exact_glossy = trace_glossy(twice);
    if (!traced.noisy_glossy || !traced.exact_glossy) return std::nullopt;
  }
  return traced;
}

std::optional<bundle::PictureError> measurePictureError(const TracedView& traced, const TracedScene& scene,
                                                        const BakedVertices& baked) {
  PictureSums sums(baked.direct.order, traced.view.eyes);
  if (traced.noisy) DiffusePoints(traced, scene, baked).addTo(sums);
  if (traced.noisy_glossy) GlossyPoints(traced, scene, baked).addTo(sums);
  return sums.result();
}

}  // namespace lambent::baker
