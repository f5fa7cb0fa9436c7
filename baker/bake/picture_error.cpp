#include "baker/bake/picture_error.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <unordered_map>

#include "baker/bake/picture_sums.hpp"
#include "baker/effects/surface/hemisphere.hpp"
#include "baker/transport/texel_samples.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

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

}  // namespace

std::optional<TracedView> traceView(const DirectPass& vertices, int glossy_order, const TracedScene& scene,
                                    const Importance& importance, const BakeContext& context) {
  TracedView traced{viewPoints(scene, importance), nullptr, nullptr, nullptr, nullptr};
  const BakeContext unkept = context.keyed(Key{});
  const char* const stage = "error of pictures";
  const std::size_t few = vertices.settings().rays, twice = kLeastTimes * few;
  const auto trace = [&](const ViewPoints& of, std::size_t rays) {
    DirectSettings settings = vertices.settings();
    settings.rays = rays;
    settings.order_out = glossy_order;
    auto points = std::make_unique<TracedPoints>(scene, of.points, settings);
    return points->look(unkept, stage) ? std::move(points) : nullptr;
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
