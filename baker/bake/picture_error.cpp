// Measures how wrong pictures show the surfaces of a group: relative RMS of the light that leaves them
// towards eyes, over real skies that the bake's bands carry, with the group's lamps as bright as in the file.
// At points that eyes see (ViewPoints), the light that vertices, codes and interpolation show is
// compared with what many rays from the point itself find, all bounces included. What few bands cannot show,
// of light or of a highlight, is no part of it, and neither is the light of lamps on glossy surfaces, nor the
// detail of normal maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/bake/bake_group.hpp"
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

// Calls take(shape, vector, what `decoded` holds) with all that codes of glossy or of other cells say of the
// samples that `decoded` names, but for light of the group's lamps on glossy ones.
template <typename Take>
void decode(const SampleSet& samples, const SurfaceCodes& codes, bool glossy, Decoded& decoded,
            const Take& take) {
  for (std::size_t c = 0; c < samples.cells.size(); ++c) {
    const SampleCell& cell = samples.cells[c];
    if ((cell.kind == SampleKind::Glossy) != glossy) continue;
    for (const CodedTransfer& coded : codes[c]) {
      if (glossy && coded.shape.order == 0) continue;
      const std::vector<float> vectors = decodeTransfer(coded);
      const std::size_t size = coded.shape.size();
      for (auto& [sample, out] : decoded)
        if (sample >= cell.first && sample < cell.first + cell.count)
          take(coded.shape, std::span(vectors).subspan((sample - cell.first) * size, size), out);
    }
  }
}

// Adds the points of diffuse and normal-mapped surfaces: light that leaves them is albedo times transfer of
// E/pi.
void addMatte(const TracedScene& scene, const SurfaceTransport& light, const SurfaceCodes* cells,
              PictureSums& sums) {
  const ViewPoints& view = light.view.of(SurfacePart::Matte);
  const Arriving arriving(scene, light.direct.field.order);
  const auto shownAt = [&](std::size_t p) {
    return shownSamples(scene.geometry, scene.samples, view.points.triangles[p], view.weights[p]);
  };
  Decoded decoded;  // three channels of each output, laid out as in a TransferField
  if (cells) {
    for (std::size_t p = 0; p < view.eyes.size(); ++p)
      if (view.seen(p))
        for (const SampleShare& shown : shownAt(p)) decoded[shown.sample];
    const auto take = [&](const transfer::TransferShape& shape, std::span<const float> vector,
                          std::vector<float>& out) {
      const std::size_t outputs = shape.outputs, own = shape.columns(),
                        first = shape.order > 0 ? 0 : arriving.bands();
      const std::size_t shadowed = shape.shadowed_channels, full = shape.full_channels;
      out.resize(3 * outputs * arriving.columns(), 0.0f);
      const auto valueAt = [&](std::size_t first_channel, std::size_t channels, std::size_t c, std::size_t j,
                               std::size_t i) {
        return vector[((first_channel + (channels == 3 ? c : 0)) * outputs + j) * own + i];
      };
      for (std::size_t j = 0; j < outputs; ++j)
        for (std::size_t c = 0; c < 3; ++c)
          for (std::size_t i = 0; i < own; ++i) {
            const float direct = valueAt(0, shadowed, c, j, i);
            float& value = out[(j * 3 + c) * arriving.columns() + first + i];
            value = full > 0 ? valueAt(shadowed, full, c, j, i) : direct;
            if (first > 0 && arriving.perPixel(i)) value -= direct;
          }
    };
    decode(scene.samples, *cells, /*glossy=*/false, decoded, take);
  }

  const std::size_t size = 3 * sums.coefficients();
  std::vector<float> many(size), few(size), fields(size), codes(size);
  using enum Arriving::Lamps;
  for (std::size_t p = 0; p < view.eyes.size(); ++p) {
    if (!view.seen(p)) continue;
    for (auto* vector : {&many, &few, &fields, &codes}) std::fill(vector->begin(), vector->end(), 0.0f);
    const auto add = [&](std::span<const float> vector, std::size_t channels, float weight,
                         Arriving::Lamps lamps, std::vector<float>& out) {
      arriving.add(vector, channels, view.points.samples.normals[p], weight, lamps, out);
    };
    const auto addPoint = [&](const TransferField& field, Arriving::Lamps lamps, std::vector<float>& out) {
      add(field.at(p), field.channels, 1.0f, lamps, out);
    };
    const TransferField& exact = view.exact->direct.field;
    addPoint(view.noisy->direct.field, All, few), addPoint(exact, All, many);
    addPoint(exact, PerPixel, fields), addPoint(exact, PerPixel, codes);
    if (light.bounced) addPoint(view.noisy->bounced, All, few), addPoint(view.exact->bounced, All, many);
    PictureSums::Point point{
        .eye = view.eyes[p], .squared_shares = 0.0, .noise_of_exact = view.noiseOfExact()};
    for (const SampleShare& shown : shownAt(p)) {
      const std::uint32_t sample = shown.sample;
      const float weight = shown.share;
      if (weight == 0.0f) continue;
      point.squared_shares += double{weight} * double{weight};
      const SampleStretch& mapped = scene.samples.normal_mapped;
      const bool nine = sample >= mapped.begin && sample < mapped.end;
      const std::size_t row = nine ? sample - mapped.begin : sample;
      const TransferField& direct = nine ? light.direct.mapped : light.direct.field;
      add(direct.at(row), direct.channels, weight, AtVertices, fields);
      if (light.bounced) {
        const TransferField& bounced = nine ? light.bounced->mapped : light.bounced->field;
        add(bounced.at(row), bounced.channels, weight, All, fields);
      }
      if (cells) add(decoded.at(sample), 3, weight, All, codes);
    }
    if (!cells) codes = fields;
    const glm::vec3 albedo =
        scene.colors.albedo(view.points.triangles[p], view.weights[p].y, view.weights[p].z);
    for (auto* vector : {&many, &few, &fields, &codes})
      for (std::size_t i = 0; i < size; ++i)
        (*vector)[i] *= albedo[static_cast<int>(i / sums.coefficients())];
    sums.add(point, {.exact = many, .noisy = few, .fields = fields, .codes = codes});
  }
}

// Adds the points of glossy surfaces: light that leaves them towards the eye is the dot product of the exit
// kernel (surface_brdfs.hpp) with the light that matrices transfer there, direct and bounced.
void addGlossy(const TracedScene& scene, const SurfaceTransport& light, const SurfaceBrdfs& brdfs,
               const SurfaceCodes* cells, PictureSums& sums) {
  const ViewPoints& view = light.view.of(SurfacePart::Glossy);
  const GlossyField& glossy = light.direct.glossy;
  const std::size_t outputs = squared(glossy.order_out), columns = squared(glossy.order_in),
                    visibility = glossy.visibilitySize(),
                    bounced = glossy.bounced.empty() ? 0 : glossy.channels * outputs * columns;
  const auto sampleOf = [&](std::size_t p, int corner) {
    return scene.samples.vertex_sample[scene.geometry.triangles[view.points.triangles[p]][corner]];
  };
  Decoded decoded;  // visibility, and then bounced light
  if (cells) {
    for (std::size_t p = 0; p < view.eyes.size(); ++p)
      for (int corner = 0; corner < 3 && view.seen(p); ++corner)
        decoded[sampleOf(p, corner)].resize(visibility + bounced);
    decode(scene.samples, *cells, /*glossy=*/true, decoded,
           [&](const transfer::TransferShape& shape, std::span<const float> vector, std::vector<float>& out) {
             const std::size_t first = shape.isVisibility() ? 0 : visibility;
             std::copy(vector.begin(), vector.end(), out.begin() + static_cast<std::ptrdiff_t>(first));
           });
  }

  // Adds a sample's visibility, and then its bounced light.
  const auto addSample = [&](const GlossyField& field, std::size_t sample, float weight,
                             std::vector<float>& out) {
    for (std::size_t i = 0; i < visibility; ++i) out[i] += weight * field.visibility[sample * visibility + i];
    for (std::size_t i = 0; i < bounced; ++i)
      out[visibility + i] += weight * field.bounced[sample * bounced + i];
  };
  std::vector<float> kernel(3 * outputs), matrix(outputs * columns);
  // Computes the radiance that leaves by the kernel where `transfer` is visibility and bounced light.
  const auto exit = [&](const std::vector<float>& transfer, std::vector<float>& out) {
    const auto back = std::span(transfer).subspan(visibility);
    std::fill(matrix.begin(), matrix.end(), 0.0f);
    sh::addVisibilityMatrix(view.exact->pass().gaunt(), std::span(transfer).first(visibility), matrix);
    std::fill(out.begin(), out.end(), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t first = glossy.channels == 3 ? c * matrix.size() : 0;
      for (std::size_t k = 0, at = 0; k < outputs; ++k)
        for (std::size_t i = 0; i < columns; ++i, ++at)
          out[c * (columns + 1) + i] +=
              kernel[c * outputs + k] * (back.empty() ? matrix[at] : matrix[at] + back[first + at]);
    }
  };
  std::vector<float> transfer(visibility + bounced), of_codes(transfer);
  std::vector<float> many(3 * (columns + 1)), few(many), fields(many), codes(many);
  for (std::size_t p = 0; p < view.eyes.size(); ++p) {
    if (!view.seen(p)) continue;
    const glm::vec3& weights = view.weights[p];
    brdfs.exitKernel(view.points.triangles[p], weights.y, weights.z, view.to_eyes[p], kernel);
    const auto leaves = [&](const TracedPoints& points, std::vector<float>& out) {
      std::fill(transfer.begin(), transfer.end(), 0.0f);
      addSample(points.direct.glossy, p, 1.0f, transfer);
      exit(transfer, out);
    };
    leaves(*view.noisy, few);
    leaves(*view.exact, many);
    std::fill(transfer.begin(), transfer.end(), 0.0f);
    std::fill(of_codes.begin(), of_codes.end(), 0.0f);
    PictureSums::Point point{.eye = view.eyes[p],
                             .weight = static_cast<double>(view.stands_for),
                             .squared_shares = 0.0,
                             .noise_of_exact = view.noiseOfExact()};
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t sample = sampleOf(p, corner);
      point.squared_shares += double{weights[corner]} * double{weights[corner]};
      addSample(glossy, sample - glossy.first_sample, weights[corner], transfer);
      if (!cells) continue;
      const std::vector<float>& held = decoded.at(sample);
      for (std::size_t i = 0; i < held.size(); ++i) of_codes[i] += weights[corner] * held[i];
    }
    exit(transfer, fields);
    if (cells) exit(of_codes, codes);
    sums.add(point, {.exact = many, .noisy = few, .fields = fields, .codes = cells ? codes : fields});
  }
}

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

// Returns the points without what is traced there.
TracedView viewPoints(const TracedScene& scene, const Importance& importance) {
  TracedView view;
  auto& [matte, glossy] = view.parts;
  for (ViewPoints* part : {&matte, &glossy}) part->points.samples.origin_offsets.push_back(0);
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
      add(seen, point, matte);
  }
  const std::size_t step = (seen_glossy.size() + kMostGlossyPoints - 1) / kMostGlossyPoints;
  for (std::size_t i = 0; i < seen_glossy.size(); i += step)
    add(seen_glossy[i].first, seen_glossy[i].second, glossy);
  glossy.stands_for = static_cast<std::uint32_t>(step);
  SampleSet &diffuse = matte.points.samples, &of_glossy = glossy.points.samples;
  diffuse.diffuse = {0, diffuse.size()};
  diffuse.normal_mapped = diffuse.glossy = {diffuse.size(), diffuse.size()};
  of_glossy.glossy = {0, of_glossy.size()};
  for (const Eye& eye : importance.eyes()) view.eye_weights.push_back(eye.weight);
  return view;
}

}  // namespace

std::optional<TracedView> traceView(const DirectPass& vertices, const GroupScene& group,
                                    const BakeContext& context) {
  const TracedScene& scene = vertices.scene();
  TracedView traced = viewPoints(scene, group.importance());
  const std::size_t few = vertices.settings().rays, twice = kLeastTimes * few;
  for (const SurfacePart part : {SurfacePart::Matte, SurfacePart::Glossy}) {
    if (stretchOf(scene.samples, part).empty()) continue;
    ViewPoints& view = traced.parts[static_cast<std::size_t>(part)];
    const auto trace = [&](std::size_t rays, std::unique_ptr<TracedPoints>& points) {
      DirectSettings settings = vertices.settings();
      settings.rays = rays;
      settings.order_out = group.bake.options.glossy_order;
      points = std::make_unique<TracedPoints>(scene, view.points, settings);
      return points->look(context.keyed(Key{}), "error of pictures");
    };
    const std::size_t many =
        part == SurfacePart::Glossy
            ? twice
            : std::max(twice, std::clamp(kTimesFewRays * few, kLeastManyRays, kMostManyRays));
    if (!trace(few, view.noisy) || !trace(many, view.exact)) return std::nullopt;
  }
  return traced;
}

std::optional<bundle::PictureError> measurePictureError(const GroupScene& group,
                                                        const SurfaceTransport& light,
                                                        const SurfaceCodes* cells) {
  const TracedScene scene = group.view();
  PictureSums sums(light.direct.field.order, light.view.eye_weights);
  if (light.view.of(SurfacePart::Matte).noisy) addMatte(scene, light, cells, sums);
  if (light.view.of(SurfacePart::Glossy).noisy) addGlossy(scene, light, *group.brdfs(), cells, sums);
  auto shown = sums.result();
  if (shown) shown->bound = group.bake.options.effectivePictureBound();
  return shown;
}

}  // namespace lambent::baker
