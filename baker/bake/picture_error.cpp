#include "baker/bake/picture_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/effects/surface/hemisphere.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kLeastPoints = 64;  // that a figure can be told from
// Eyes that get less than this share of the light of the mean eye, in squares, stand in the dark between
// walls.
constexpr double kLeastLight = 1.0 / 400.0;
constexpr double kWhite = 4.0;  // times the RMS of the light that an eye sees
// Band powers are relative to band 0, whose square is 4 pi under a sky with a mean radiance of 1.
constexpr double kLampPower = 1.0 / (4.0 * std::numbers::pi);

// Sums up how wrong the light is that leaves points towards eyes, relative RMS over real skies with lamps as
// in the file, and divides the error among its causes. A few points that are very bright, or very wrong,
// count no more than a screen would show of them.
class PictureSums {
 public:
  // `eye_weights` are shares of all pictures.
  PictureSums(int order, std::vector<float> eye_weights)
      : coefficients_(static_cast<std::size_t>(sh::coefficientCount(order))),
        eye_weights_(std::move(eye_weights)),
        of_eye_(eye_weights_.size()) {}

  // The number of coefficients of a channel: those of the environment, then one for all lamps together.
  std::size_t coefficients() const { return coefficients_ + 1; }

  // The radiance that leaves a point as a function of the environment: coefficients of red, then of green,
  // then of blue. `exact` comes from many rays from the point, `noisy` from as many as a vertex has; `fields`
  // is interpolated between vertices, and `codes` from what codes hold of these.
  struct Shown {
    std::span<const float> exact, noisy, fields, codes;
  };
  struct Point {
    std::uint32_t eye = 0;
    double weight = 1.0;          // the number of points for which it stands
    double squared_shares = 1.0;  // the sum of the squares of the vertices' shares
    // The share of the squared difference between few and many rays that the many make.
    double noise_of_exact = 0.0;
  };
  void add(const Point& point, const Shown& shown) {
    const double noise = squareOf(shown.noisy, shown.exact);
    of_eye_[point.eye].push_back({.weight = point.weight,
                                  .light = squareOf(shown.exact, {}),
                                  .all = squareOf(shown.codes, shown.exact) - point.noise_of_exact * noise,
                                  .codes = squareOf(shown.codes, shown.fields),
                                  .samples = point.squared_shares * (1.0 - point.noise_of_exact) * noise});
  }

  // Every eye counts by its weight alone, as it gets used to the light. Returns nothing if too few points
  // were added.
  std::optional<bundle::PictureError> result() const {
    std::vector<double> light(of_eye_.size(), 0.0);  // mean square of each eye
    double mean = 0.0, weights = 0.0;
    for (std::size_t e = 0; e < of_eye_.size(); ++e) {
      double sum = 0.0, count = 0.0;
      for (const Squares& at : of_eye_[e]) sum += at.weight * at.light, count += at.weight;
      if (count > 0.0) light[e] = sum / count;
      mean += double{eye_weights_[e]} * light[e], weights += double{eye_weights_[e]};
    }
    if (weights > 0.0) mean /= weights;
    double all = 0.0, codes = 0.0, samples = 0.0;
    weights = 0.0;
    std::size_t points = 0;
    for (std::size_t e = 0; e < of_eye_.size(); ++e) {
      if (!(light[e] > kLeastLight * mean)) continue;
      // A screen that shows the mean as middle grey clips light that is kWhite times as bright.
      const double white = kWhite * kWhite * light[e];
      double of_light = 0.0, of_all = 0.0, of_codes = 0.0, of_samples = 0.0;
      for (const Squares& at : of_eye_[e]) {
        const double shown = at.all > white ? white / at.all : 1.0;
        of_light += at.weight * std::min(at.light, white);
        of_all += at.weight * shown * at.all;
        of_codes += at.weight * shown * at.codes, of_samples += at.weight * shown * at.samples;
      }
      const double weight = double{eye_weights_[e]};
      all += weight * of_all / of_light, codes += weight * of_codes / of_light;
      samples += weight * of_samples / of_light;
      weights += weight;
      points += of_eye_[e].size();
    }
    if (points < kLeastPoints) return std::nullopt;
    const auto root = [&](double sum) { return static_cast<float>(std::sqrt(std::max(0.0, sum / weights))); };
    return bundle::PictureError{.all = root(all),
                                .samples = root(samples),
                                .codes = root(codes),
                                .interpolation = root(all - codes - samples),
                                .points = static_cast<std::uint32_t>(points)};
  }

 private:
  double squareOf(std::span<const float> a, std::span<const float> b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double difference = double{a[i]} - (b.empty() ? 0.0 : double{b[i]});
      const std::size_t at = i % (coefficients_ + 1);
      const double power = at == coefficients_
                               ? kLampPower
                               : kBandPower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(at)))];
      sum += power * difference * difference;
    }
    return sum;
  }

  struct Squares {  // at one point
    double weight, light, all, codes, samples;
  };
  std::size_t coefficients_;  // of the environment
  std::vector<float> eye_weights_;
  std::vector<std::vector<Squares>> of_eye_;
};

// Points are looked at by so many times the rays of vertices, within these limits, but always by more. Glossy
// ones have only kLeastTimes as many, since light between glossy surfaces is dear to gather; the noise of
// both is known and taken off.
constexpr std::size_t kTimesFewRays = 8, kLeastManyRays = 1024, kMostManyRays = 4096, kLeastTimes = 2;

// Adds up what arrives at points: for red, green and blue, the coefficients of the environment and then the
// light of all lamps together.
class Arriving {
 public:
  Arriving(const TracedScene& scene, int order)
      : scene_(scene), bands_(squared(order)), per_pixel_(shadedPerPixel(scene.lights)) {}

  // Which lamps count: those that are shaded per pixel send direct light that is exact, so that of vertices
  // is not shown.
  enum class Lamps : std::uint8_t { All, AtVertices, PerPixel };

  std::size_t bands() const { return bands_; }
  std::size_t columns() const { return bands_ + per_pixel_.size(); }
  bool perPixel(std::size_t lamp) const { return per_pixel_[lamp]; }

  // Adds `weight` times a sample's vector, which is laid out as in a TransferField. A vector of nine outputs
  // is evaluated at `normal` (hemisphere.hpp).
  void add(std::span<const float> vector, std::size_t channels, const glm::vec3& normal, float weight,
           Lamps lamps, std::span<float> out) const {
    const std::size_t outputs = vector.size() / (channels * columns());
    const std::array<float, kIncident> shares = sharesOf(normal);
    for (std::size_t j = 0; j < outputs; ++j)
      for (std::size_t c = 0; c < 3; ++c)
        addRow(vector.subspan((j * channels + (channels == 3 ? c : 0)) * columns(), columns()), c,
               outputs == 1 ? weight : weight * shares[j], lamps, out);
  }

 private:
  void addRow(std::span<const float> row, std::size_t c, float weight, Lamps lamps,
              std::span<float> out) const {
    const auto to = out.subspan(c * (bands_ + 1), bands_ + 1);
    for (std::size_t i = 0; lamps != Lamps::PerPixel && i < bands_; ++i) to[i] += weight * row[i];
    for (std::size_t k = 0; k < per_pixel_.size(); ++k)
      if (lamps == Lamps::All || per_pixel_[k] == (lamps == Lamps::PerPixel))
        to[bands_] += weight * row[bands_ + k] * scene_.lights[k].color[static_cast<int>(c)];
  }
  static std::array<float, kIncident> sharesOf(const glm::vec3& normal) {
    std::array<float, kIncident> shares{};
    sh::evaluate<float>(3, normal.x, normal.y, normal.z, shares);
    for (int j = 0; j < int{kIncident}; ++j)
      shares[static_cast<std::size_t>(j)] *=
          static_cast<float>(sh::clampedCosine(sh::bandOf(j)) / std::numbers::pi);
    return shares;
  }

  const TracedScene& scene_;
  std::size_t bands_;
  std::vector<bool> per_pixel_;
};

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

// The points of diffuse and normal-mapped surfaces: light that leaves them is albedo times transfer of E/pi.
class DiffusePoints {
 public:
  DiffusePoints(const TracedView& traced, const TracedScene& scene, const BakedVertices& baked)
      : points_(traced.view.diffuse),
        traced_(traced),
        scene_(scene),
        baked_(baked),
        arriving_(scene, baked.direct.field.order) {}

  void addTo(PictureSums& sums) {
    decode();
    const auto& noisy = traced_.noisy->direct;
    const auto& exact = traced_.exact->direct;
    const double noise_of_exact =
        noiseOfMany(traced_.noisy->pass().settings().rays, traced_.exact->pass().settings().rays);
    const std::size_t size = 3 * sums.coefficients();
    std::vector<float> many(size), few(size), fields(size), codes(size);
    using enum Arriving::Lamps;
    for (std::size_t p = 0; p < points_.eyes.size(); ++p) {
      if (!seen(p)) continue;
      for (auto* vector : {&many, &few, &fields, &codes}) std::fill(vector->begin(), vector->end(), 0.0f);
      const auto addPoint = [&](const TransferField& field, Arriving::Lamps lamps, std::vector<float>& out) {
        arriving_.add(field.at(p), field.channels, points_.points.samples.normals[p], 1.0f, lamps, out);
      };
      addPoint(noisy.field, All, few), addPoint(exact.field, All, many);
      addPoint(exact.field, PerPixel, fields), addPoint(exact.field, PerPixel, codes);
      if (baked_.bounced)
        addPoint(traced_.noisy->bounced, All, few), addPoint(traced_.exact->bounced, All, many);
      PictureSums::Point point{
          .eye = points_.eyes[p], .squared_shares = 0.0, .noise_of_exact = noise_of_exact};
      for (const SampleShare& shown : shownAt(p)) {
        const std::uint32_t sample = shown.sample;
        const float weight = shown.share;
        if (weight == 0.0f) continue;
        point.squared_shares += double{weight} * double{weight};
        const auto addShown = [&](std::span<const float> vector, std::size_t channels, Arriving::Lamps lamps,
                                  std::vector<float>& out) {
          arriving_.add(vector, channels, points_.points.samples.normals[p], weight, lamps, out);
        };
        const SampleStretch& mapped = scene_.samples.normal_mapped;
        const bool nine = sample >= mapped.begin && sample < mapped.end;
        const std::size_t row = nine ? sample - mapped.begin : sample;
        const TransferField& direct = nine ? baked_.direct.mapped : baked_.direct.field;
        addShown(direct.at(row), direct.channels, AtVertices, fields);
        if (baked_.bounced) {
          const TransferField& bounced = nine ? baked_.bounced->mapped : baked_.bounced->field;
          addShown(bounced.at(row), bounced.channels, All, fields);
        }
        if (baked_.cells) addShown(decoded_.at(sample), 3, All, codes);
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
    return traced_.noisy->direct.looks.valid[p] != 0 && traced_.exact->direct.looks.valid[p] != 0;
  }
  void decode() {
    if (!baked_.cells) return;
    for (std::size_t p = 0; p < points_.eyes.size(); ++p)
      if (seen(p))
        for (const SampleShare& shown : shownAt(p)) decoded_[shown.sample];
    for (std::size_t c = 0; c < scene_.samples.cells.size(); ++c)
      if (const SampleCell& cell = scene_.samples.cells[c]; cell.kind != SampleKind::Glossy)
        for (const CodedTransfer& coded : (*baked_.cells)[c]) decode(cell, coded);
  }
  void decode(const SampleCell& cell, const CodedTransfer& coded) {
    const std::size_t outputs = coded.shape.outputs, own = coded.shape.columns(),
                      first = coded.shape.order > 0 ? 0 : arriving_.bands();
    const std::size_t shadowed = coded.shape.shadowed_channels, full = coded.shape.full_channels;
    decodeCell(cell, coded, decoded_, [&](std::span<const float> vector, std::vector<float>& out) {
      out.resize(3 * outputs * arriving_.columns(), 0.0f);
      const auto valueAt = [&](std::size_t first_channel, std::size_t channels, std::size_t c, std::size_t j,
                               std::size_t i) {
        return vector[((first_channel + (channels == 3 ? c : 0)) * outputs + j) * own + i];
      };
      for (std::size_t j = 0; j < outputs; ++j)
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t i = 0; i < own; ++i) {
            const float direct = valueAt(0, shadowed, c, j, i);
            float& value = out[(j * 3 + c) * arriving_.columns() + first + i];
            value = full > 0 ? valueAt(shadowed, full, c, j, i) : direct;
            if (first > 0 && arriving_.perPixel(i)) value -= direct;
          }
    });
  }

  const ViewPoints& points_;
  const TracedView& traced_;
  const TracedScene& scene_;
  const BakedVertices& baked_;
  Arriving arriving_;
  Decoded decoded_;  // three channels of each output, laid out as in a TransferField
};

// The points of glossy surfaces: light that leaves them towards the eye is the dot product of the exit
// kernel (surface_brdfs.hpp) with the light that matrices transfer there, direct and bounced.
class GlossyPoints {
 public:
  GlossyPoints(const TracedView& traced, const TracedScene& scene, const BakedVertices& baked)
      : points_(traced.view.glossy),
        traced_(traced),
        scene_(scene),
        baked_(baked),
        glossy_(baked.direct.glossy),
        outputs_(squared(glossy_.order_out)),
        columns_(squared(glossy_.order_in)),
        kernel_(3 * outputs_),
        matrix_(outputs_ * columns_) {}

  void addTo(PictureSums& sums) {
    decode();
    const GlossyField &noisy = traced_.noisy_glossy->direct.glossy,
                      &exact = traced_.exact_glossy->direct.glossy;
    const double noise_of_exact = noiseOfMany(traced_.noisy_glossy->pass().settings().rays,
                                              traced_.exact_glossy->pass().settings().rays);
    const std::size_t size = glossy_.visibilitySize() + bouncedSize();
    std::vector<float> transfer(size), of_codes(size);
    std::vector<float> many(3 * (columns_ + 1)), few(many), fields(many), codes(many);
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
        addSample(glossy_, sample - glossy_.first_sample, weights[corner], transfer);
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
    return glossy_.bounced.empty() ? 0 : glossy_.channels * outputs_ * columns_;
  }
  bool seen(std::size_t p) const {
    return traced_.noisy_glossy->direct.looks.valid[p] != 0 &&
           traced_.exact_glossy->direct.looks.valid[p] != 0;
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
    const auto visibility = transfer.first(glossy_.visibilitySize());
    const auto bounced = transfer.subspan(visibility.size());
    std::fill(matrix_.begin(), matrix_.end(), 0.0f);
    sh::addVisibilityMatrix(traced_.exact_glossy->pass().gaunt(), visibility, matrix_);
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t first = glossy_.channels == 3 ? c * matrix_.size() : 0;
      for (std::size_t k = 0, at = 0; k < outputs_; ++k)
        for (std::size_t i = 0; i < columns_; ++i, ++at)
          out[c * (columns_ + 1) + i] +=
              kernel_[c * outputs_ + k] * (bounced.empty() ? matrix_[at] : matrix_[at] + bounced[first + at]);
    }
  }
  void decode() {
    if (!baked_.cells) return;
    for (std::size_t p = 0; p < points_.eyes.size(); ++p)
      for (int corner = 0; corner < 3 && seen(p); ++corner)
        decoded_[sampleOf(p, corner)].resize(glossy_.visibilitySize() + bouncedSize());
    for (std::size_t c = 0; c < scene_.samples.cells.size(); ++c) {
      const SampleCell& cell = scene_.samples.cells[c];
      if (cell.kind != SampleKind::Glossy) continue;
      for (const CodedTransfer& coded : (*baked_.cells)[c]) {
        if (coded.shape.order == 0) continue;  // light of the group's lamps
        const std::size_t first = coded.shape.isVisibility() ? 0 : glossy_.visibilitySize();
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
  const GlossyField& glossy_;
  std::size_t outputs_, columns_;
  std::vector<float> kernel_, matrix_;
  Decoded decoded_;  // visibility, and then bounced light
};

constexpr std::size_t kViewRays = 1536, kMostGlossyPoints = 400;  // of all eyes together

void add(const SeenPoint& seen, const FacePoint& point, ViewPoints& out) {
  SampleSet& set = out.points.samples;
  out.points.triangles.push_back(seen.hit.triangle);
  set.positions.push_back(point.position);
  set.normals.push_back(point.normal);
  set.origins.push_back(point.origin);
  set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
  out.weights.emplace_back(1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v);
  out.to_eyes.push_back(seen.to_eye);
  out.eyes.push_back(seen.eye);
}

View viewPoints(const TracedScene& scene, const Importance& importance) {
  View view;
  SampleSet &diffuse = view.diffuse.points.samples, &glossy = view.glossy.points.samples;
  diffuse.origin_offsets.push_back(0), glossy.origin_offsets.push_back(0);
  std::vector<std::pair<SeenPoint, FacePoint>> seen_glossy;
  for (const SeenPoint& seen : importance.look(kViewRays, scene.geometry, scene.rays)) {
    const glm::uvec3 corners = scene.geometry.triangles[seen.hit.triangle];
    const FacePoint point =
        facePoint(scene.geometry, corners, {1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v});
    if (!(glm::dot(point.normal, point.origin.geometric_normal) > 0.0f)) continue;
    const std::uint32_t sample = scene.samples.vertex_sample[corners.x];
    if (sample >= scene.samples.glossy.begin && sample < scene.samples.glossy.end)
      seen_glossy.emplace_back(seen, point);
    else
      add(seen, point, view.diffuse);
  }
  const std::size_t step = (seen_glossy.size() + kMostGlossyPoints - 1) / kMostGlossyPoints;
  for (std::size_t i = 0; i < seen_glossy.size(); i += step)
    add(seen_glossy[i].first, seen_glossy[i].second, view.glossy);
  view.glossy.stands_for = static_cast<std::uint32_t>(step);
  diffuse.diffuse = {0, diffuse.size()};
  diffuse.normal_mapped = diffuse.glossy = {diffuse.size(), diffuse.size()};
  glossy.glossy = {0, glossy.size()};
  for (const Eye& eye : importance.eyes()) view.eye_weights.push_back(eye.weight);
  return view;
}

}  // namespace

std::optional<TracedView> traceView(const DirectPass& vertices, int glossy_order, const TracedScene& scene,
                                    const Importance& importance, const BakeContext& context) {
  TracedView traced{viewPoints(scene, importance), nullptr, nullptr, nullptr, nullptr};
  const std::size_t few = vertices.settings().rays, twice = kLeastTimes * few;
  const auto trace = [&](const ViewPoints& of, std::size_t rays) {
    DirectSettings settings = vertices.settings();
    settings.rays = rays;
    settings.order_out = glossy_order;
    auto points = std::make_unique<TracedPoints>(scene, of.points, settings);
    return points->look(context.keyed(Key{}), "error of pictures") ? std::move(points) : nullptr;
  };
  if (scene.samples.glossy.begin > 0) {
    traced.noisy = trace(traced.view.diffuse, few);
    traced.exact = trace(traced.view.diffuse,
                         std::max(twice, std::clamp(kTimesFewRays * few, kLeastManyRays, kMostManyRays)));
    if (!traced.noisy || !traced.exact) return std::nullopt;
  }
  if (!scene.samples.glossy.empty()) {
    traced.noisy_glossy = trace(traced.view.glossy, few);
    traced.exact_glossy = trace(traced.view.glossy, twice);
    if (!traced.noisy_glossy || !traced.exact_glossy) return std::nullopt;
  }
  return traced;
}

std::optional<bundle::PictureError> measurePictureError(const TracedView& traced, const TracedScene& scene,
                                                        const BakedVertices& baked) {
  PictureSums sums(baked.direct.field.order, traced.view.eye_weights);
  if (traced.noisy) DiffusePoints(traced, scene, baked).addTo(sums);
  if (traced.noisy_glossy) GlossyPoints(traced, scene, baked).addTo(sums);
  return sums.result();
}

}  // namespace lambent::baker
