#include "baker/bake/picture_sums.hpp"

#include <algorithm>
#include <cmath>

#include "baker/compress/light_weights.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kLeastPoints = 64;  // that a figure can be told from
// Eyes that get less than this share of the light of the mean eye, in squares, stand in the dark between
// walls.
constexpr double kLeastLight = 1.0 / 400.0;

}  // namespace

PictureSums::PictureSums(int order, std::size_t eyes)
    : coefficients_(static_cast<std::size_t>(sh::coefficientCount(order))), of_eye_(eyes) {}

void PictureSums::add(const Point& point, const Shown& shown) {
  const double noise = squareOf(shown.noisy, shown.exact);
  OfEye& sums = of_eye_[point.eye];
  sums.light += point.weight * squareOf(shown.exact, {});
  sums.all += point.weight * (squareOf(shown.codes, shown.exact) - point.noise_of_exact * noise);
  sums.codes += point.weight * squareOf(shown.codes, shown.fields);
  sums.samples += point.weight * point.squared_shares * (1.0 - point.noise_of_exact) * noise;
  ++sums.points;
}

std::optional<bundle::PictureError> PictureSums::result() const {
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

double PictureSums::squareOf(std::span<const float> a, std::span<const float> b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = double{a[i]} - (b.empty() ? 0.0 : double{b[i]});
    const int band = sh::bandOf(static_cast<int>(i % coefficients_));
    sum += kBandPower[static_cast<std::size_t>(band)] * difference * difference;
  }
  return sum;
}

}  // namespace lambent::baker
