#include "baker/accuracy/compare.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

namespace {

double percentile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Two infinite depths (no surface) are the same. NaN differs from every depth.
bool sameDepth(float a, float b) {
  return a == b || std::abs(a - b) <= kSameDepth * std::min(a, b);
}

bool haveDepths(std::initializer_list<const spec::RgbaImage*> pictures) {
  return std::ranges::none_of(pictures, [](const spec::RgbaImage* p) { return p->depths.empty(); });
}

// These sums give relative_rms.
struct Sums {
  double squares = 0.0, energy = 0.0;
  std::uint64_t pixels = 0;

  void add(const glm::dvec3& x, const glm::dvec3& a, const glm::dvec3& b) {
    squares += glm::dot(x - a, x - b);
    energy += glm::dot(a, b);
    ++pixels;
  }
  double relativeRms() const { return std::sqrt(std::max(squares, 0.0) / energy); }
};

}  // namespace

Result<PictureError> comparePictures(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                     const spec::RgbaImage* reference2, const std::string& subject) {
  const spec::RgbaImage& second = reference2 ? *reference2 : reference;
  for (const spec::RgbaImage* other : {&reference, &second})
    if (other->width != picture.width || other->height != picture.height)
      return fail(subject,
                  fmt::format("is {} x {}, the reference {} x {}", picture.width, picture.height,
                              other->width, other->height),
                  "draw both with the same --size");
  PictureError error;
  Sums all, same_surface;
  double noise_squares = 0.0;
  glm::dvec3 difference_sum(0.0), reference_sum(0.0);
  std::vector<double> differences;
  const bool depths = haveDepths({&picture, &reference, &second});
  for (std::size_t i = 0; i < picture.texels.size(); ++i) {
    const auto [least, most] = std::minmax({picture.texels[i].w, reference.texels[i].w, second.texels[i].w});
    // A pixel of an outline that is just above the bound in one picture and just below in another does not
    // count.
    error.pixels_apart += most >= spec::kLeastCoverage && least < 0.5f * spec::kLeastCoverage;
    if (!(least >= spec::kLeastCoverage)) continue;
    const glm::dvec3 x(picture.texels[i]), a(reference.texels[i]), b(second.texels[i]), mean = 0.5 * (a + b);
    if (!isFinite(x) || !isFinite(a) || !isFinite(b))
      return fail(
          subject,
          fmt::format("or its reference is not finite at pixel {}, {}", i % picture.width, i / picture.width),
          "draw it again");
    all.add(x, a, b);
    if (depths && sameDepth(picture.depths[i], reference.depths[i]) &&
        sameDepth(picture.depths[i], second.depths[i]) && sameDepth(reference.depths[i], second.depths[i]))
      same_surface.add(x, a, b);
    // With d the error and p, q the noise of A and B, (d - p)(d - q) varies by -d (p + q) + pq. The variance
    // of that equals that of (d - (p + q)/2)(p - q), which can be measured.
    const double noise = glm::dot(x - mean, a - b);
    noise_squares += noise * noise;
    difference_sum += x - mean;
    reference_sum += mean;
    differences.push_back(glm::length(x - mean));
  }
  if (differences.empty())
    return fail(subject, "covers no pixel that its reference covers", "use the same camera for both");
  if (!(all.energy > 0.0))
    return fail(subject, "has a black reference", "use a light that reaches the scene");

  error.pixels = all.pixels;
  error.relative_rms = all.relativeRms();
  if (depths) error.pixels_of_other_surfaces = all.pixels - same_surface.pixels;
  if (same_surface.energy > 0.0) error.same_surface_rms = same_surface.relativeRms();
  error.relative_square_error = std::sqrt(noise_squares) / all.energy;
  for (int k = 0; k < 3; ++k)
    error.bias[static_cast<std::size_t>(k)] =
        reference_sum[k] != 0.0 ? difference_sum[k] / reference_sum[k] : 0.0;
  const double scale = std::sqrt(all.energy / static_cast<double>(error.pixels));
  error.median = percentile(differences, 0.5) / scale;
  error.percentile_95 = percentile(differences, 0.95) / scale;
  error.percentile_99 = percentile(differences, 0.99) / scale;
  error.largest = *std::max_element(differences.begin(), differences.end()) / scale;
  return error;
}

Result<spec::RgbaImage> shrunk(const spec::RgbaImage& picture, std::uint32_t n, const std::string& subject) {
  if (n == 1) return picture;
  if (n < 1 || picture.width % n != 0 || picture.height % n != 0)
    return fail(subject,
                fmt::format("{} x {} pixels cannot be shrunk by {}", picture.width, picture.height, n),
                "shrink by a number that divides both");
  spec::RgbaImage out{picture.width / n, picture.height / n, {}};
  out.texels.reserve(std::size_t{out.width} * out.height);
  const double share = 1.0 / (static_cast<double>(n) * static_cast<double>(n));
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      glm::dvec4 sum(0.0);
      for (std::uint32_t row = y * n; row < (y + 1) * n; ++row)
        for (std::uint32_t column = x * n; column < (x + 1) * n; ++column)
          sum += glm::dvec4(picture.texels[std::size_t{row} * picture.width + column]);
      out.texels.emplace_back(share * sum);
    }
  return out;
}

namespace {

using Color = std::array<std::uint8_t, 3>;

// ColorBrewer's RdBu in 11 steps, reversed.
constexpr std::array<Color, 11> kColors = {{{5, 48, 97},
                                            {33, 102, 172},
                                            {67, 147, 195},
                                            {146, 197, 222},
                                            {209, 229, 240},
                                            {247, 247, 247},
                                            {253, 219, 199},
                                            {244, 165, 130},
                                            {214, 96, 77},
                                            {178, 24, 43},
                                            {103, 0, 31}}};
constexpr Color kUncovered = {48, 48, 48}, kApart = {150, 60, 220};
constexpr float kFloor = 0.05f;  // relative to the picture's RMS luminance

struct Pixels {
  std::vector<float> values;  // values of the map in pixels that all pictures cover
  std::vector<std::uint32_t> at, apart;
};

// Counts pixels as comparePictures() does.
Pixels pixelsOf(const spec::RgbaImage& picture, const spec::RgbaImage& a, const spec::RgbaImage& b) {
  Pixels out;
  for (std::uint32_t i = 0; i < picture.texels.size(); ++i) {
    const auto [least, most] = std::minmax({picture.texels[i].w, a.texels[i].w, b.texels[i].w});
    if (least >= spec::kLeastCoverage)
      out.at.push_back(i);
    else if (most >= spec::kLeastCoverage && least < 0.5f * spec::kLeastCoverage)
      out.apart.push_back(i);
  }
  return out;
}

void measure(Pixels& pixels, const spec::RgbaImage& picture, const spec::RgbaImage& a,
             const spec::RgbaImage& b) {
  const auto mean = [&](std::uint32_t i) { return 0.5f * (a.texels[i] + b.texels[i]); };
  double squares = 0.0;
  for (const std::uint32_t i : pixels.at) {
    const double y = double{spec::luminanceOf(mean(i))};
    squares += y * y;
  }
  const auto scale =
      std::max(static_cast<float>(std::sqrt(squares / static_cast<double>(pixels.at.size()))), 1e-30f);
  pixels.values.reserve(pixels.at.size());
  for (const std::uint32_t i : pixels.at)
    pixels.values.push_back(spec::luminanceOf(picture.texels[i] - mean(i)) /
                            std::max(spec::luminanceOf(mean(i)), kFloor * scale));
}

// Rounds up to 1, 2 or 5 times a power of ten; equal pictures get a thousandth.
double rounded(double range) {
  if (!(range > 1e-3)) return 1e-3;
  const double power = std::pow(10.0, std::floor(std::log10(range)));
  for (const double step : {1.0, 2.0, 5.0})
    if (range <= step * power * (1.0 + 1e-9)) return step * power;
  return 10.0 * power;
}

double rangeOf(std::span<const float> values) {
  std::vector<float> sizes(values.size());
  std::transform(values.begin(), values.end(), sizes.begin(), [](float v) { return std::abs(v); });
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), at, sizes.end());
  return rounded(double{*at});
}

void put(spec::Rgba8Image& image, std::uint32_t i, const Color& color) {
  std::copy(color.begin(), color.end(), image.texels.begin() + 4 * static_cast<std::ptrdiff_t>(i));
}

}  // namespace

std::array<std::uint8_t, 3> heatColor(double share) {
  const double at = std::clamp(0.5 * (share + 1.0), 0.0, 1.0) * static_cast<double>(kColors.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kColors.size() - 2);
  Color out;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double from = kColors[low][k], to = kColors[low + 1][k];
    out[k] = static_cast<std::uint8_t>(std::lround(glm::mix(from, to, at - static_cast<double>(low))));
  }
  return out;
}

Result<Difference> differenceOf(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                const spec::RgbaImage* reference2, std::optional<double> range,
                                const std::string& subject) {
  if (range && !(*range > 0.0 && std::isfinite(*range)))
    return fail("--heat-range", fmt::format("{} is not a range", *range), "give a share above 0, as 0.1");
  auto figures = comparePictures(picture, reference, reference2, subject);
  if (!figures) return failAgain(std::move(figures.error()));
  const spec::RgbaImage& second = reference2 ? *reference2 : reference;
  Pixels pixels = pixelsOf(picture, reference, second);
  measure(pixels, picture, reference, second);
  Difference out{.figures = *figures,
                 .heat = {.width = picture.width,
                          .height = picture.height,
                          .texels = std::vector<std::uint8_t>(4 * picture.texels.size(), 255)},
                 .range = range ? *range : rangeOf(pixels.values)};
  // All pixels share one table, so that colours are interpolated once.
  constexpr int kSteps = 512;
  std::array<Color, kSteps + 1> table;
  constexpr double kLeast = -1.0;
  for (int k = 0; k <= kSteps; ++k)
    table[static_cast<std::size_t>(k)] = heatColor(glm::mix(kLeast, 1.0, k / double{kSteps}));
  for (std::uint32_t i = 0; i < picture.texels.size(); ++i) put(out.heat, i, kUncovered);
  for (const std::uint32_t i : pixels.apart) put(out.heat, i, kApart);
  for (std::size_t p = 0; p < pixels.at.size(); ++p) {
    const double share = std::clamp(double{pixels.values[p]} / out.range, kLeast, 1.0);
    put(out.heat, pixels.at[p],
        table[static_cast<std::size_t>(std::lround((share - kLeast) / (1.0 - kLeast) * kSteps))]);
  }
  return out;
}

}  // namespace lambent::baker
