#include "baker/bake/picture_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/compress/light_weights.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kRays = 1536;  // of all eyes together

// A Seer collects what eyes see.
class Seer {
 public:
  explicit Seer(const TracedScene& scene) : scene_(scene) {
    for (ViewPoints* points : {&view_.diffuse, &view_.glossy})
      points->points.samples.origin_offsets.push_back(0);
  }

  void add(const SeenPoint& seen_point) {
    const GroupGeometry& geometry = scene_.geometry;
    const FirstHit& hit = seen_point.hit;
    const glm::uvec3 corners = geometry.triangles[hit.triangle];
    const std::uint32_t sample = scene_.samples.vertex_sample[corners.x];
    const auto in = [&](const SampleStretch& stretch) {
      return sample >= stretch.begin && sample < stretch.end;
    };
    const bool glossy = in(scene_.samples.glossy);
    const FacePoint point = facePoint(geometry, corners, {1.0f - hit.u - hit.v, hit.u, hit.v});
    if (!(glm::dot(point.normal, point.origin.geometric_normal) > 0.0f)) return;
    const Seen seen{hit, seen_point.to_eye, seen_point.eye, point};
    if (glossy)
      glossy_.push_back(seen);
    else
      add(seen, view_.diffuse);
  }

  View finish() {
    const std::size_t step = (glossy_.size() + kMostGlossyPoints - 1) / kMostGlossyPoints;
    for (std::size_t i = 0; i < glossy_.size(); i += step) add(glossy_[i], view_.glossy);
    view_.glossy.stands_for = static_cast<std::uint32_t>(step);
    SampleSet &diffuse = view_.diffuse.points.samples, &glossy = view_.glossy.points.samples;
    diffuse.diffuse = {0, diffuse.size()};
    diffuse.normal_mapped = diffuse.glossy = {diffuse.size(), diffuse.size()};
    glossy.glossy = {0, glossy.size()};
    return std::move(view_);
  }

 private:
  struct Seen {
    FirstHit hit;
    glm::vec3 to_eye;
    std::uint32_t eye;
    FacePoint point;
  };

  static void add(const Seen& seen, ViewPoints& out) {
    SampleSet& set = out.points.samples;
    out.points.triangles.push_back(seen.hit.triangle);
    set.positions.push_back(seen.point.position);
    set.normals.push_back(seen.point.normal);
    set.origins.push_back(seen.point.origin);
    set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
    out.weights.emplace_back(1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v);
    out.to_eyes.push_back(seen.to_eye);
    out.eyes.push_back(seen.eye);
  }

  const TracedScene& scene_;
  View view_;
  std::vector<Seen> glossy_;
};

}  // namespace

View viewPoints(const TracedScene& scene, const Importance& importance) {
  Seer seer(scene);
  for (const SeenPoint& seen : importance.look(kRays, scene.geometry, scene.rays)) seer.add(seen);
  View view = seer.finish();
  for (const Eye& eye : importance.eyes()) view.eye_weights.push_back(eye.weight);
  return view;
}

namespace {

constexpr std::size_t kLeastPoints = 64;  // that a figure can be told from
// Eyes that get less than this share of the light of the mean eye, in squares, stand in the dark between
// walls.
constexpr double kLeastLight = 1.0 / 400.0;
constexpr double kWhite = 4.0;  // times the RMS of the light that an eye sees
// Band powers are relative to band 0, whose square is 4 pi under a sky with a mean radiance of 1.
constexpr double kLampPower = 1.0 / (4.0 * std::numbers::pi);

}  // namespace

PictureSums::PictureSums(int order, std::vector<float> eye_weights)
    : coefficients_(static_cast<std::size_t>(sh::coefficientCount(order))),
      eye_weights_(std::move(eye_weights)),
      of_eye_(eye_weights_.size()) {}

void PictureSums::add(const Point& point, const Shown& shown) {
  const double noise = squareOf(shown.noisy, shown.exact);
  of_eye_[point.eye].push_back({.weight = point.weight,
                                .light = squareOf(shown.exact, {}),
                                .all = squareOf(shown.codes, shown.exact) - point.noise_of_exact * noise,
                                .codes = squareOf(shown.codes, shown.fields),
                                .samples = point.squared_shares * (1.0 - point.noise_of_exact) * noise});
}

std::optional<bundle::PictureError> PictureSums::result() const {
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
    // Where a screen shows the mean as middle grey, it clips what is so many times as bright.
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

double PictureSums::squareOf(std::span<const float> a, std::span<const float> b) const {
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

}  // namespace lambent::baker
