#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "baker/accuracy/compare.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::baker {

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
