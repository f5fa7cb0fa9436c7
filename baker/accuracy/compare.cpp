#include "baker/accuracy/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

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

// Pixels that all pictures cover, and that one covers and that are sky in another.
struct Pixels {
  std::vector<std::uint32_t> at, apart;
};

Result<PictureError> compare(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                             const spec::RgbaImage& second, const std::string& subject, Pixels& pixels) {
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
  for (std::uint32_t i = 0; i < picture.texels.size(); ++i) {
    const auto [least, most] = std::minmax({picture.texels[i].w, reference.texels[i].w, second.texels[i].w});
    // A pixel of an outline that is just above the bound in one picture and just below in another does not
    // count.
    if (most >= spec::kLeastCoverage && least < 0.5f * spec::kLeastCoverage) pixels.apart.push_back(i);
    if (!(least >= spec::kLeastCoverage)) continue;
    pixels.at.push_back(i);
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
  error.pixels_apart = pixels.apart.size();
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

}  // namespace

Result<PictureError> comparePictures(const spec::RgbaImage& picture, const spec::RgbaImage& reference,
                                     const spec::RgbaImage* reference2, const std::string& subject) {
  Pixels pixels;
  return compare(picture, reference, reference2 ? *reference2 : reference, subject, pixels);
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

// Returns the values of the map in pixels that all pictures cover.
std::vector<float> valuesAt(std::span<const std::uint32_t> pixels, const spec::RgbaImage& picture,
                            const spec::RgbaImage& a, const spec::RgbaImage& b) {
  const auto mean = [&](std::uint32_t i) { return 0.5f * (a.texels[i] + b.texels[i]); };
  double squares = 0.0;
  for (const std::uint32_t i : pixels) {
    const double y = double{spec::luminanceOf(mean(i))};
    squares += y * y;
  }
  const auto scale =
      std::max(static_cast<float>(std::sqrt(squares / static_cast<double>(pixels.size()))), 1e-30f);
  std::vector<float> values;
  for (const std::uint32_t i : pixels)
    values.push_back(spec::luminanceOf(picture.texels[i] - mean(i)) /
                     std::max(spec::luminanceOf(mean(i)), kFloor * scale));
  return values;
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
  const spec::RgbaImage& second = reference2 ? *reference2 : reference;
  Pixels pixels;
  auto figures = compare(picture, reference, second, subject, pixels);
  if (!figures) return failAgain(std::move(figures.error()));
  const std::vector<float> values = valuesAt(pixels.at, picture, reference, second);
  Difference out{.figures = *figures,
                 .heat = {.width = picture.width,
                          .height = picture.height,
                          .texels = std::vector<std::uint8_t>(4 * picture.texels.size(), 255)},
                 .range = range ? *range : rangeOf(values)};
  // All pixels share one table, so that colours are interpolated once.
  constexpr int kSteps = 512;
  std::array<Color, kSteps + 1> table;
  constexpr double kLeast = -1.0;
  for (int k = 0; k <= kSteps; ++k)
    table[static_cast<std::size_t>(k)] = heatColor(glm::mix(kLeast, 1.0, k / double{kSteps}));
  for (std::uint32_t i = 0; i < picture.texels.size(); ++i) put(out.heat, i, kUncovered);
  for (const std::uint32_t i : pixels.apart) put(out.heat, i, kApart);
  for (std::size_t p = 0; p < pixels.at.size(); ++p) {
    const double share = std::clamp(double{values[p]} / out.range, kLeast, 1.0);
    put(out.heat, pixels.at[p],
        table[static_cast<std::size_t>(std::lround((share - kLeast) / (1.0 - kLeast) * kSteps))]);
  }
  return out;
}

namespace {

constexpr float kWhite = 100.0f;    // cd/m²
constexpr double kFieldDeg = 45.0;  // of the picture's width
constexpr std::size_t kLevels = 8;  // of blurring
constexpr std::size_t kContrasts = kLevels - 2;
constexpr float kLeast = 1e-5f;  // luminance, against division by zero

// Returns the sensitivity to a contrast of so many cycles per degree at this luminance (Barten 1989).
float sensitivity(float cycles_per_degree, float luminance) {
  const float a = 440.0f * std::pow(1.0f + 0.7f / luminance, -0.2f);
  const float b = 0.3f * std::pow(1.0f + 100.0f / luminance, 0.15f);
  const float f = cycles_per_degree;
  return a * f * std::exp(-b * f) * std::sqrt(1.0f + 0.06f * std::exp(b * f));
}

// Returns the smallest difference of luminance that an adapted eye can tell (Ward Larson et al. 1997).
float threshold(float luminance) {
  const float l = std::log10(luminance);
  if (l < -3.94f) return std::pow(10.0f, -2.86f);
  if (l < -1.44f) return std::pow(10.0f, std::pow(0.405f * l + 1.6f, 2.18f) - 2.86f);
  if (l < -0.0184f) return std::pow(10.0f, l - 0.395f);
  if (l < 1.9f) return std::pow(10.0f, std::pow(0.249f * l + 0.65f, 2.7f) - 0.72f);
  return std::pow(10.0f, l - 1.255f);
}

// Returns by how much a contrast raises the threshold for others of its frequency (Daly 1993).
float masking(float contrast) {
  const float a = std::pow(392.498f * contrast, 0.7f), b = std::pow(0.0153f * a, 4.0f);
  return std::pow(1.0f + b, 0.25f);
}

// Returns a and b of CIE L*a*b* under the white of Rec. 709.
glm::vec2 chromaOf(const glm::vec3& xyz) {
  const auto root = [](float t) { return t > 0.008856f ? std::cbrt(t) : 7.787f * t + 16.0f / 116.0f; };
  const float x = root(xyz.x / 0.9505f), y = root(xyz.y), z = root(xyz.z / 1.0891f);
  return {500.0f * (x - y), 200.0f * (y - z)};
}

using Plane = std::vector<float>;

// An eye gets this of a picture: luminance in cd/m², ever more blurred, and chroma.
struct Seen {
  std::array<Plane, kLevels> luminance;
  std::vector<glm::vec2> chroma;
};

// Blurs by the kernel of Burt and Adelson (1983) along one axis, mirrored at the borders.
Plane blurred(const Plane& in, int width, int height, int dx, int dy) {
  constexpr std::array kKernel = {0.05f, 0.25f, 0.4f, 0.25f, 0.05f};
  const auto mirrored = [](int i, int size) {
    if (i < 0) i = -i;
    if (i >= size) i = 2 * size - 2 - i;
    return std::clamp(i, 0, size - 1);
  };
  Plane out(in.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f;
      for (int k = -2; k <= 2; ++k)
        sum +=
            kKernel[static_cast<std::size_t>(k + 2)] *
            in[static_cast<std::size_t>(mirrored(y + k * dy, height) * width + mirrored(x + k * dx, width))];
      out[static_cast<std::size_t>(y * width + x)] = sum;
    }
  return out;
}

Seen seen(const spec::Rgba8Image& picture) {
  const glm::mat3 xyz_from_rgb(glm::vec3(0.4124f, 0.2126f, 0.0193f), glm::vec3(0.3576f, 0.7152f, 0.1192f),
                               glm::vec3(0.1805f, 0.0722f, 0.9505f));
  const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  Seen out;
  for (std::size_t i = 0; i < picture.texels.size(); i += 4) {
    glm::vec3 rgb;
    for (int c = 0; c < 3; ++c)
      rgb[c] =
          spec::linearFromSrgb(static_cast<float>(picture.texels[i + static_cast<std::size_t>(c)]) / 255.0f);
    const glm::vec3 xyz = xyz_from_rgb * rgb;
    out.luminance.front().push_back(kWhite * xyz.y);
    out.chroma.push_back(chromaOf(xyz));
  }
  for (std::size_t level = 1; level < kLevels; ++level)
    out.luminance[level] =
        blurred(blurred(out.luminance[level - 1], width, height, 1, 0), width, height, 0, 1);
  return out;
}

float contrastOf(const Seen& picture, std::size_t level, std::size_t pixel) {
  return std::abs(picture.luminance[level][pixel] - picture.luminance[level + 1][pixel]) /
         std::max(picture.luminance[level + 2][pixel], kLeast);
}

}  // namespace

Result<double> visibleShare(const spec::Rgba8Image& picture, const spec::Rgba8Image& reference,
                            const std::string& subject) {
  if (picture.width != reference.width || picture.height != reference.height)
    return fail(subject,
                fmt::format("is {} x {}, the reference {} x {}", picture.width, picture.height,
                            reference.width, reference.height),
                "draw both with the same --size");
  if (picture.texels.empty()) return 0.0;
  const Seen a = seen(picture), b = seen(reference);
  // A screen is flat, so degrees are counted at its middle.
  const double degrees =
      2.0 * std::tan(0.5 * kFieldDeg * std::numbers::pi / 180.0) * 180.0 / std::numbers::pi;
  const auto adapted = std::min(kLevels - 1, static_cast<std::size_t>(std::ceil(std::log2(degrees))));
  std::array<float, kContrasts> frequency{},
      elevation{};  // cycles per degree, and how much harder they are to see
  for (std::size_t i = 0; i < kContrasts; ++i) {
    frequency[i] = static_cast<float>(0.5 * static_cast<double>(picture.width) / degrees / std::exp2(i));
    elevation[i] = sensitivity(3.248f, kWhite) / sensitivity(frequency[i], kWhite);
  }
  const std::size_t pixels = a.chroma.size();
  std::size_t visible = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const float adaptation =
        std::max(0.5f * (a.luminance[adapted][pixel] + b.luminance[adapted][pixel]), kLeast);
    float sum = 0.0f, raised = 0.0f;
    for (std::size_t i = 0; i < kContrasts; ++i) {
      const float contrast = std::max(contrastOf(a, i, pixel), contrastOf(b, i, pixel));
      sum += contrast;
      raised += contrast * elevation[i] * masking(contrast * sensitivity(frequency[i], adaptation));
    }
    const float factor = std::clamp(raised / std::max(sum, kLeast), 1.0f, 10.0f);
    const float difference = std::abs(a.luminance.front()[pixel] - b.luminance.front()[pixel]);
    // Eyes see colours only where there is enough light.
    const float colour = std::min(adaptation / 10.0f, 1.0f);
    const glm::vec2 chroma = a.chroma[pixel] - b.chroma[pixel];
    visible +=
        difference > factor * threshold(adaptation) || glm::dot(chroma, chroma) * colour * colour > factor;
  }
  return static_cast<double>(visible) / static_cast<double>(pixels);
}

}  // namespace lambent::baker
