#include "assets/environment_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::assets {

glm::dvec3 integrate(const spec::RgbImage& image) {
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  glm::dvec3 sum(0.0);
  for (int y = 0; y < height; ++y) {
    glm::dvec3 row(0.0);
    for (int x = 0; x < width; ++x)
      row +=
          glm::dvec3(image.texels[static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)]);
    sum += row * sh::texelSolidAngle(sh::ImageLayout::LatLong, width, height, 0, y);
  }
  return sum;
}

namespace {

// Makes an image of width x width / 2 texels, each the mean of samples x samples directions.
spec::RgbImage latLongImage(std::uint32_t width, int samples,
                            const std::function<glm::dvec3(glm::dvec3 dir)>& radiance) {
  spec::RgbImage image{width, width / 2, {}};
  const int fine_width = static_cast<int>(width) * samples, fine_height = fine_width / 2;
  for (int y = 0; y < static_cast<int>(image.height); ++y)
    for (int x = 0; x < static_cast<int>(image.width); ++x) {
      glm::dvec3 sum(0.0);
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i)
          sum += radiance(sh::texelDirection(sh::ImageLayout::LatLong, fine_width, fine_height,
                                             x * samples + i, y * samples + j));
      image.texels.emplace_back(sum / double(samples * samples));
    }
  return image;
}

double luminance(glm::dvec3 colour) {
  return glm::dot(colour, glm::dvec3(0.2126, 0.7152, 0.0722));
}

// Scales the image to a mean luminance of 1.
void normalise(spec::RgbImage& image) {
  const double mean = luminance(integrate(image)) / (4 * std::numbers::pi);
  for (glm::vec3& texel : image.texels) texel *= static_cast<float>(1.0 / mean);
}

// Makes a clear sky after A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for Daylight",
// SIGGRAPH 1999, appendix A.2: Perez' distribution for luminance Y and chromaticities x and y, whose
// coefficients are linear in the turbidity.

constexpr double kPi = std::numbers::pi;
constexpr double kTurbidity = 3.0;  // clear, a little hazy
constexpr float kSunAzimuthDeg = 34.0f, kSunElevationDeg = 44.0f;
// The disc is wider than the sun's 0.27 degrees, at the same irradiance, so that small images and low orders
// can show it.
constexpr double kSunRadius = 2.6 * kPi / 180;
// This is the ratio of the sun's irradiance, on a surface that faces it, to the sky's irradiance on a
// horizontal plane. It is about 6 in clear air; 2.5 is a sun behind thin haze, which keeps shadows readable
// in low orders.
constexpr double kSunToSky = 2.5;
const glm::dvec3 kSunColour(1.0, 0.90, 0.76);
const glm::dvec3 kGroundAlbedo(0.26, 0.23, 0.19);

// F(theta, gamma) = (1 + A exp(B / cos theta)) (1 + C exp(D gamma) + E cos² gamma)
struct Perez {
  double a, b, c, d, e;
  double at(double cos_theta, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / cos_theta)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

constexpr double kT = kTurbidity;
constexpr Perez kLuminance = {0.1787 * kT - 1.4630, -0.3554 * kT + 0.4275, -0.0227 * kT + 5.3251,
                              0.1206 * kT - 2.5771, -0.0670 * kT + 0.3703};
constexpr Perez kChromaX = {-0.0193 * kT - 0.2592, -0.0665 * kT + 0.0008, -0.0004 * kT + 0.2125,
                            -0.0641 * kT - 0.8989, -0.0033 * kT + 0.0452};
constexpr Perez kChromaY = {-0.0167 * kT - 0.2608, -0.0950 * kT + 0.0092, -0.0079 * kT + 0.2102,
                            -0.0441 * kT - 1.6537, -0.0109 * kT + 0.0529};

// Returns the chromaticity at the zenith: a quadratic in the turbidity of cubics in the sun's angle from the
// zenith.
double zenithChroma(const std::array<std::array<double, 4>, 3>& m, double sun) {
  const auto cubic = [&](const std::array<double, 4>& c) {
    return ((c[0] * sun + c[1]) * sun + c[2]) * sun + c[3];
  };
  return kT * kT * cubic(m[0]) + kT * cubic(m[1]) + cubic(m[2]);
}

glm::dvec3 fromXyy(double x, double y, double luminance) {
  const glm::dvec3 xyz(x / y * luminance, luminance, (1 - x - y) / y * luminance);
  const glm::dmat3 rec709_from_xyz(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259,
                                   -0.4985314, 0.0415560, 1.0572252);
  return glm::max(rec709_from_xyz * xyz, glm::dvec3(0.0));
}

class Sky {
 public:
  explicit Sky(glm::dvec3 to_sun) : to_sun_(to_sun), sun_(std::acos(to_sun.y)) {
    x_ = zenithChroma({{{0.00166, -0.00375, 0.00209, 0.0},
                        {-0.02903, 0.06377, -0.03202, 0.00394},
                        {0.11693, -0.21196, 0.06052, 0.25886}}},
                      sun_);
    y_ = zenithChroma({{{0.00275, -0.00610, 0.00317, 0.0},
                        {-0.04214, 0.08970, -0.04153, 0.00516},
                        {0.15346, -0.26756, 0.06670, 0.26688}}},
                      sun_);
  }

  // The luminance at the zenith is 1. The model ends at the horizon, so directions below use its values
  // there.
  glm::dvec3 operator()(glm::dvec3 dir) const {
    constexpr double kLowest = 0.01;
    const double cos_theta = std::max(dir.y, kLowest);
    const double gamma = std::acos(std::clamp(glm::dot(dir, to_sun_), -1.0, 1.0));
    const auto relative = [&](const Perez& perez) {
      return perez.at(cos_theta, gamma) / perez.at(1.0, sun_);
    };
    return fromXyy(x_ * relative(kChromaX), y_ * relative(kChromaY), relative(kLuminance));
  }

 private:
  glm::dvec3 to_sun_;
  double sun_;  // angle from the zenith
  double x_, y_;
};

glm::dvec3 irradianceFromAbove(const spec::RgbImage& image) {
  spec::RgbImage weighted = image;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const double up = std::cos(kPi * (y + 0.5) / image.height);
    for (std::uint32_t x = 0; x < image.width; ++x)
      weighted.texels[y * image.width + x] *= static_cast<float>(std::max(up, 0.0));
  }
  return integrate(weighted);
}

}  // namespace

spec::RgbImage skyMap(std::uint32_t width) {
  const glm::dvec3 to_sun(spec::directionFromAzimuthElevation(kSunAzimuthDeg, kSunElevationDeg));
  const Sky sky(to_sun);
  spec::RgbImage image = latLongImage(width, 2, [&](glm::dvec3 dir) { return sky(dir); });
  const glm::dvec3 sky_irradiance = irradianceFromAbove(image);

  // Texels get their coverage by the disc, and are then scaled so that the irradiance is exact.
  spec::RgbImage sun = latLongImage(width, 8, [&](glm::dvec3 dir) {
    return glm::dot(dir, to_sun) > std::cos(kSunRadius) ? kSunColour : glm::dvec3(0.0);
  });
  const double sun_irradiance = kSunToSky * luminance(sky_irradiance);
  const double scale = sun_irradiance / luminance(integrate(sun));

  const glm::dvec3 on_ground =
      sky_irradiance + kSunColour / luminance(kSunColour) * sun_irradiance * to_sun.y;
  const glm::dvec3 ground = kGroundAlbedo * on_ground / kPi;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    // Haze fades the ground into the lowest sky over five degrees.
    const double elevation_deg = 90.0 - 180.0 * (y + 0.5) / image.height;
    const double above = glm::smoothstep(-5.0, 0.0, elevation_deg);
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t i = std::size_t{y} * image.width + x;
      image.texels[i] =
          glm::vec3(glm::mix(ground, glm::dvec3(image.texels[i]), above) + scale * glm::dvec3(sun.texels[i]));
    }
  }
  normalise(image);
  return image;
}

namespace {

// A SoftBox is a rectangle on the sphere's tangent plane at its centre, with a soft rim like diffusing cloth.
struct SoftBox {
  glm::dvec3 centre, right, up;
  double half_width, half_height;  // on the plane at distance 1
  glm::dvec3 radiance;

  SoftBox(float azimuth_deg, float elevation_deg, double width_deg, double height_deg, glm::dvec3 colour)
      : centre(spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg)),
        right(spec::directionFromAzimuthElevation(azimuth_deg + 90.0f, 0.0f)),
        up(glm::cross(centre, right)),
        half_width(std::tan(width_deg * std::numbers::pi / 360)),
        half_height(std::tan(height_deg * std::numbers::pi / 360)),
        radiance(colour) {}

  glm::dvec3 seenAlong(glm::dvec3 dir) const {
    constexpr double kRim = 0.06;
    const double distance = glm::dot(dir, centre);
    if (distance <= 0.0) return glm::dvec3(0.0);
    const double x = std::abs(glm::dot(dir, right)) / distance, y = std::abs(glm::dot(dir, up)) / distance;
    const double inside = (1 - glm::smoothstep(half_width - kRim, half_width + kRim, x)) *
                          (1 - glm::smoothstep(half_height - kRim, half_height + kRim, y));
    // A lamp behind the cloth makes it brightest in the middle.
    return radiance * inside *
           (1.0 - 0.3 * (x * x / (half_width * half_width) + y * y / (half_height * half_height)) / 2);
  }
};

}  // namespace

spec::RgbImage studioMap(std::uint32_t width) {
  const std::array<SoftBox, 3> boxes = {{
      {48.0f, 40.0f, 54.0, 42.0, {16.0, 12.6, 8.8}},  // key: warm, from the right in front
      {-62.0f, 24.0f, 46.0, 62.0, {2.6, 3.5, 5.0}},   // fill: large and cool, from the left
      {172.0f, 58.0f, 70.0, 24.0, {7.0, 7.0, 6.8}},   // rim: neutral, from behind and above
  }};
  spec::RgbImage image = latLongImage(width, 4, [&](glm::dvec3 dir) {
    // Dark grey walls get a little lighter towards the ceiling; the floor reflects some warm light.
    glm::dvec3 sum = glm::mix(glm::dvec3(0.16, 0.14, 0.12), glm::dvec3(0.10, 0.10, 0.11),
                              glm::smoothstep(-0.35, 0.05, dir.y));
    sum += glm::dvec3(0.06) * glm::smoothstep(0.3, 1.0, dir.y);
    for (const SoftBox& box : boxes) sum += box.seenAlong(dir);
    return sum;
  });
  normalise(image);
  return image;
}

}  // namespace lambent::assets
