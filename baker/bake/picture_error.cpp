#include "baker/bake/picture_error.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "baker/compress/light_weights.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

// Points are looked at by so many times the rays of vertices, within these limits, but always by more.
constexpr std::size_t kTimesFewRays = 8, kLeastManyRays = 1024, kMostManyRays = 4096, kLeastTimes = 2;
constexpr std::size_t kLeastPoints = 64;  // that a figure can be told from
// Eyes that get less than this share of the light of the mean eye, in squares, stand in the dark between
// walls.
constexpr double kLeastLight = 1.0 / 400.0;

// Collects what of the light at points is wrong. A vector holds the coefficients of red, green and blue.
class Sums {
 public:
  // `noise_of_exact` is the share of the squared difference between few and many rays that the many make.
  Sums(int order, std::size_t eyes, double noise_of_exact)
      : coefficients_(static_cast<std::size_t>(sh::coefficientCount(order))),
        noise_of_exact_(noise_of_exact),
        of_eye_(eyes) {}

  std::size_t coefficients() const { return coefficients_; }

  struct Shown {
    std::span<const float> exact, noisy, fields, codes;
  };
  void add(std::uint32_t eye, const glm::vec3& albedo, double squared_shares, const Shown& shown) {
    const auto square = [&](std::span<const float> a, std::span<const float> b) {
      return squareOf(albedo, a, b);
    };
    const double noise = square(shown.noisy, shown.exact);
    OfEye& sums = of_eye_[eye];
    sums.light += square(shown.exact, {});
    sums.all += square(shown.codes, shown.exact) - noise_of_exact_ * noise;
    sums.codes += square(shown.codes, shown.fields);
    sums.samples += squared_shares * (1.0 - noise_of_exact_) * noise;
    ++sums.points;
  }

  // Every eye counts alike, as it gets used to the light.
  std::optional<bundle::PictureError> result() const {
    double light = 0.0;
    for (const OfEye& sums : of_eye_) light += sums.light / static_cast<double>(of_eye_.size());
    double all = 0.0, codes = 0.0, samples = 0.0;
    std::size_t eyes = 0, points = 0;
    for (const OfEye& sums : of_eye_) {
      if (!(sums.light > kLeastLight * light)) continue;
      all += sums.all / sums.light, codes += sums.codes / sums.light, samples += sums.samples / sums.light;
      ++eyes;
      points += sums.points;
    }
    if (points < kLeastPoints) return std::nullopt;
    const auto root = [&](double sum) {
      return static_cast<float>(std::sqrt(std::max(0.0, sum / static_cast<double>(eyes))));
    };
    return bundle::PictureError{.all = root(all),
                                .samples = root(samples),
                                .codes = root(codes),
                                .interpolation = root(all - codes - samples),
                                .points = static_cast<std::uint32_t>(points)};
  }

 private:
  double squareOf(const glm::vec3& albedo, std::span<const float> a, std::span<const float> b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double difference = double{albedo[static_cast<int>(i / coefficients_)]} *
                                (double{a[i]} - (b.empty() ? 0.0 : double{b[i]}));
      const int band = sh::bandOf(static_cast<int>(i % coefficients_));
      sum += kBandPower[static_cast<std::size_t>(band)] * difference * difference;
    }
    return sum;
  }

  struct OfEye {
    double light = 0.0, all = 0.0, codes = 0.0, samples = 0.0;
    std::size_t points = 0;
  };
  std::size_t coefficients_;
  double noise_of_exact_;
  std::vector<OfEye> of_eye_;
};

// Adds `weight` times the environment's part of a sample's vector to all channels of `out`.
void addWeighted(const TransferField& field, std::size_t sample, float weight, std::span<float> out) {
  const auto from = field.at(sample);
  const std::size_t size = out.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t row = (field.channels == 3 ? c : 0) * field.columns;
    for (std::size_t i = 0; i < size; ++i) out[c * size + i] += weight * from[row + i];
  }
}

// The environment's transfer of diffuse samples as codes hold it, with all bounces: three channels.
using Decoded = std::unordered_map<std::uint32_t, std::vector<float>>;

// Fills in the samples that `decoded` names.
void decode(const TracedScene& scene, const std::vector<std::vector<CodedTransfer>>& cells,
            Decoded& decoded) {
  for (std::size_t c = 0; c < scene.samples.cells.size(); ++c) {
    const SampleCell& cell = scene.samples.cells[c];
    if (cell.kind != SampleKind::Diffuse) continue;
    const CodedTransfer& coded = cells[c].front();
    const std::vector<float> vectors = decodeTransfer(coded);
    const std::size_t size = coded.shape.columns(), shadowed = coded.shape.shadowed_channels * size;
    const std::uint32_t full = coded.shape.full_channels;
    const std::uint32_t channels = full > 0 ? full : coded.shape.shadowed_channels;
    for (auto& [sample, out] : decoded) {
      if (sample < cell.first || sample >= cell.first + cell.count) continue;
      const auto from =
          std::span(vectors).subspan((sample - cell.first) * coded.shape.size() + (full > 0 ? shadowed : 0));
      out.resize(3 * size);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = from[channels == 3 ? i : i % size];
    }
  }
}

}  // namespace

std::optional<TracedView> traceView(const DirectPass& vertices, const TracedScene& scene,
                                    const BakeContext& context) {
  TracedView traced{viewPoints(scene), nullptr, nullptr};
  const auto trace = [&](std::size_t rays) {
    DirectSettings settings = vertices.settings();
    settings.rays = rays;
    auto points = std::make_shared<TracedPoints>(scene, traced.view.points, settings);
    return points->look(context.keyed(Key{}), "error of pictures") ? points : nullptr;
  };
  const std::size_t few = vertices.settings().rays;
  traced.noisy = trace(few);
  traced.exact =
      trace(std::max(kLeastTimes * few, std::clamp(kTimesFewRays * few, kLeastManyRays, kMostManyRays)));
  if (!traced.noisy || !traced.exact) return std::nullopt;
  return traced;
}

std::optional<bundle::PictureError> measurePictureError(const TracedView& traced, const TracedScene& scene,
                                                        const BakedVertices& baked) {
  const ViewPoints& view = traced.view;
  const auto& noisy = traced.noisy->direct();
  const auto& exact = traced.exact->direct();
  const auto seen = [&](std::size_t p) { return noisy.looks.valid[p] != 0 && exact.looks.valid[p] != 0; };
  const auto shownAt = [&](std::size_t p) {
    return shownSamples(scene.geometry, scene.samples, view.points.triangles[p], view.weights[p]);
  };
  Decoded decoded;
  for (std::size_t p = 0; p < view.eyes.size(); ++p)
    if (baked.cells && seen(p))
      for (const SampleShare& shown : shownAt(p)) decoded[shown.sample];
  if (baked.cells) decode(scene, *baked.cells, decoded);

  const auto few_rays = static_cast<double>(traced.noisy->pass().settings().rays),
             many_rays = static_cast<double>(traced.exact->pass().settings().rays);
  Sums sums(baked.direct.order, view.eyes.empty() ? 0 : view.eyes.back() + 1,
            few_rays / (few_rays + many_rays));
  const std::size_t size = 3 * sums.coefficients();
  std::vector<float> many(size), few(size), fields(size), codes(size);
  for (std::size_t p = 0; p < view.eyes.size(); ++p) {
    if (!seen(p)) continue;
    for (auto* vector : {&many, &few, &fields, &codes}) std::fill(vector->begin(), vector->end(), 0.0f);
    addWeighted(noisy.field, p, 1.0f, few);
    addWeighted(exact.field, p, 1.0f, many);
    if (!baked.bounced_at_points.empty()) {
      addWeighted(baked.bounced_at_points[0], p, 1.0f, few);
      addWeighted(baked.bounced_at_points[1], p, 1.0f, many);
    }
    float squared_shares = 0.0f;
    for (const auto& [sample, weight] : shownAt(p)) {
      squared_shares += weight * weight;
      addWeighted(baked.direct, sample, weight, fields);
      if (baked.bounced) addWeighted(*baked.bounced, sample, weight, fields);
      if (!baked.cells) continue;
      const std::vector<float>& of_codes = decoded.at(sample);
      for (std::size_t i = 0; i < size; ++i) codes[i] += weight * of_codes[i];
    }
    if (!baked.cells) codes = fields;
    sums.add(view.eyes[p], view.albedos[p], squared_shares,
             {.exact = many, .noisy = few, .fields = fields, .codes = codes});
  }
  return sums.result();
}

}  // namespace lambent::baker
