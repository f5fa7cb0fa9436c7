// Compares key lights in whole pictures with closed forms: light through a window, and a sky map that makes a
// full turn.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/live_stage.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BuiltMesh;
using testing::BundleBuilder;
using testing::LiveStage;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kOrder = 5;

// Makes a white rectangle with these half sides, which are perpendicular; it faces along their cross product.
BuiltMesh rectangle(const glm::vec3& center, const glm::vec3& right, const glm::vec3& up) {
  return {testing::quadMesh(),
          {},
          glm::mat4(glm::vec4(right, 0), glm::vec4(up, 0),
                    glm::vec4(glm::normalize(glm::cross(right, up)), 0), glm::vec4(center, 1))};
}

spec::RgbaImage pictureOf(LiveStage& stage, const spec::View& view) {
  const Result<void> done = stage.frame->render(stage.world, stage.environment, view);
  EXPECT_TRUE(done) << done.error().line();
  return stage.frame->readLinear();
}

// Looks straight down, 2 `half` wide; x to the right, z downwards.
spec::View down(float half, float from) {
  return {
      .view_from_world = glm::lookAt(glm::vec3(0, from, 0), glm::vec3(0, from - 1, 0), glm::vec3(0, 0, -1)),
      .clip_from_view = glm::ortho(-half, half, -half, half, 0.0f, 20.0f),
      .eye_ws = {0, from, 0}};
}

// Makes a room of 2 m, closed but for a window in the wall towards +X. All light is a key light, so none
// comes by harmonics; they know every place for open, so that maps alone tell what arrives.
constexpr float kLow = 0.2f, kHigh = 0.8f, kHalfWidth = 0.4f;
BundleBuilder roomWithWindow() {
  BundleBuilder builder(kOrder);
  builder.transfer([](const glm::vec3&) {
    std::vector<float> open(kOrder * kOrder, 0.0f);
    open[0] = 1.0f;
    return open;
  });
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.add(rectangle(-y, z, x)).add(rectangle(y, x, z));
  builder.add(rectangle(-z, x, y)).add(rectangle(z, y, x)).add(rectangle(-x, y, z));
  // These are the parts of the wall around the window: below, above, and at both sides.
  const auto part = [&](float low, float high, float from, float to) {
    builder.add(rectangle({1, 0.5f * (low + high), 0.5f * (from + to)}, 0.5f * (to - from) * z,
                          0.5f * (high - low) * y));
  };
  part(-1, kLow, -1, 1);
  part(kHigh, 1, -1, 1);
  part(kLow, kHigh, -1, -kHalfWidth);
  part(kLow, kHigh, kHalfWidth, 1);
  return builder;
}

}  // namespace

using KeyClosedForms = testing::GpuTest;

TEST_F(KeyClosedForms, WhatFallsThroughAWindowLiesOnTheFloor) {
  constexpr std::uint32_t kSide = 256;
  const BundleBuilder room = roomWithWindow();
  for (const float azimuth : {105.0f, 75.0f})
    for (const float radius : {0.27f, 2.0f, 5.0f}) {
      constexpr float kElevation = 50.0f;
      const float sine = std::sin(glm::radians(radius));
      // E/pi of a surface that faces it is 1.
      LiveStage stage(room, {spec::SunLight{.azimuth_deg = azimuth,
                                            .elevation_deg = kElevation,
                                            .angle_deg = radius,
                                            .radiance = glm::vec3(1.0f / (sine * sine))}});
      stage.environment.setMostKeys(16);
      stage.frame->resize({kSide, kSide});
      ASSERT_EQ(stage.environment.keys().size(), 1u);
      const spec::RgbaImage image = pictureOf(stage, down(1.0f, 0.9f));
      double sum = 0.0;
      for (const glm::vec4& texel : image.texels) sum += double{texel.r};
      const double on_floor = sum * 4.0 / (kSide * kSide);
      const double through = double{2.0f * kHalfWidth * (kHigh - kLow)} * std::cos(glm::radians(kElevation)) *
                             std::cos(glm::radians(azimuth - 90.0f));
      EXPECT_NEAR(on_floor / through, 1.0, 0.01) << "azimuth " << azimuth << ", radius " << radius;
    }
}

namespace {

// The tower has a square ground plan, and is too high for the sun to shine over it on the floor.
constexpr float kTower = 0.25f, kTall = 20.0f;
constexpr float kRadius = 3.0f, kElevation = 40.0f;  // degrees, of the sun in the map

// Returns the fraction of a disc's light on a floor that comes from azimuths smaller than its centre's plus
// an angle: quadrature over the disc, by the azimuth of each of its points.
class DiscByAzimuth {
 public:
  DiscByAzimuth(const glm::vec3& direction, float radius_rad) {
    const glm::vec3 beside = glm::normalize(glm::cross(glm::vec3(0, 1, 0), direction)),
                    up = glm::cross(direction, beside);
    constexpr int kCount = 20000;
    std::vector<std::pair<double, double>> points;  // azimuth beyond the middle's, cosine
    for (int i = 0; i < kCount; ++i) {
      const float z = 1.0f - (1.0f - std::cos(radius_rad)) * (static_cast<float>(i) + 0.5f) / kCount;
      const float turn = 2.399963f * static_cast<float>(i), around = std::sqrt(1.0f - z * z);
      const glm::vec3 d = z * direction + around * (std::cos(turn) * beside + std::sin(turn) * up);
      const float ahead = glm::dot(d, glm::normalize(glm::vec3(direction.x, 0, direction.z))),
                  aside = glm::dot(d, beside);
      points.emplace_back(std::atan2(aside, ahead), d.y);
    }
    std::ranges::sort(points);
    double sum = 0.0;
    for (const auto& [azimuth, cosine] : points) {
      azimuths_.push_back(azimuth);
      sums_.push_back(sum += cosine);
    }
    for (double& one : sums_) one /= sum;
  }
  double below(double azimuth) const {
    const auto found = std::ranges::lower_bound(azimuths_, azimuth);
    return found == azimuths_.begin() ? 0.0 : sums_[static_cast<std::size_t>(found - azimuths_.begin()) - 1];
  }

 private:
  std::vector<double> azimuths_, sums_;
};

// Wraps an angle to -pi to pi.
double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Returns an azimuth as in DiscByAzimuth, whose axis cross(up, d) is +X for d along +Z.
double azimuthOf(double x, double z) {
  return std::atan2(x, z);
}

// Returns the fraction of the disc that a point of the floor sees past the tower.
double seenPastTower(const DiscByAzimuth& disc, const glm::vec3& sun, const glm::vec3& place) {
  const double middle = azimuthOf(-place.x, -place.z), to_sun = azimuthOf(sun.x, sun.z);
  double low = 0.0, high = 0.0;
  for (const float x : {-kTower, kTower})
    for (const float z : {-kTower, kTower}) {
      const double beside = wrapped(azimuthOf(x - place.x, z - place.z) - middle);
      low = testing::smaller(low, beside), high = testing::larger(high, beside);
    }
  const double from = wrapped(middle - to_sun);
  return 1.0 - (disc.below(from + high) - disc.below(from + low));
}

// Compares the changes of pixels from step to step with the expected ones, in units of the sun's light.
struct Changes {
  double largest = 0.0, expected_largest = 0.0, square_sum = 0.0;
  std::size_t count = 0, far_off = 0;

  void add(double change, double expected) {
    constexpr double kFarOff = 0.1;
    largest = testing::larger(largest, std::abs(change));
    expected_largest = testing::larger(expected_largest, std::abs(expected));
    square_sum += (change - expected) * (change - expected);
    far_off += std::abs(change - expected) > kFarOff ? 1 : 0;
    ++count;
  }
  double rms() const { return std::sqrt(square_sum / static_cast<double>(count)); }
};

// Writes a sun in a sky that is brighter to one side.
std::filesystem::path writeSky(const glm::vec3& sun) {
  spec::RgbImage environment_map{.width = 256, .height = 128, .texels = {}};
  for (std::uint32_t y = 0; y < environment_map.height; ++y)
    for (std::uint32_t x = 0; x < environment_map.width; ++x) {
      const glm::vec3 d(
          sh::texelDirection(sh::ImageLayout::LatLong, 256, 128, static_cast<int>(x), static_cast<int>(y)));
      const bool in_sun = glm::dot(d, sun) > std::cos(glm::radians(kRadius));
      environment_map.texels.push_back(in_sun ? glm::vec3(300, 270, 230)
                                              : glm::vec3(0.3f, 0.4f, 0.6f) * (1.0f + 0.5f * d.x));
    }
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / fmt::format("{}-turn.hdr", getpid());
  EXPECT_TRUE(spec::writeHdr(file, environment_map));
  return file;
}

BundleBuilder tower() {
  BundleBuilder builder(kOrder);
  builder.add(rectangle({0, 0, 0}, {0, 0, 3}, {3, 0, 0}));
  for (const float side : {-1.0f, 1.0f}) {
    const glm::vec3 rise(0, 0.5f * kTall, 0);
    builder.add(rectangle(side * glm::vec3(kTower, 0, 0) + rise, {0, 0, -side * kTower}, rise));
    builder.add(rectangle(side * glm::vec3(0, 0, kTower) + rise, {side * kTower, 0, 0}, rise));
  }
  builder.add(rectangle({0, kTall, 0}, {0, 0, kTower}, {kTower, 0, 0}));
  return builder;
}

}  // namespace

TEST_F(KeyClosedForms, ASkyThatTurnsAllTheWayRoundChangesPixelsAsItsShadowsMove) {
  const float up = glm::radians(kElevation);
  const std::filesystem::path file = writeSky({0, std::sin(up), std::cos(up)});
  LiveStage stage(tower(), {spec::EnvironmentMapLight{.file = file, .layout = {}}});
  std::filesystem::remove(file);
  stage.environment.setMostKeys(16);
  constexpr std::uint32_t kSide = 40;
  constexpr float kHalf = 1.0f;
  stage.frame->resize({kSide, kSide});
  const spec::View view = down(kHalf, 10.0f);
  ASSERT_EQ(stage.environment.keys().size(), 1u);
  const spec::Disc key = stage.environment.keys()[0];
  EXPECT_NEAR(glm::degrees(key.radius_rad), kRadius, 0.05f) << "the sun that was found";
  const DiscByAzimuth disc(key.direction, key.radius_rad);
  const double sine = std::sin(double{key.radius_rad});
  const double of_sun = double{key.radiance.r} * sine * sine * double{key.direction.y};  // E/pi on the floor
  // The rest is the same for all rotations, because the floor is level. It includes the sun's ragged rim,
  // which the disc does not cover.
  const sh::LightVector rest = stage.environment.restLight();
  std::vector<float> open(kOrder * kOrder);
  sh::unoccludedTransfer(kOrder, glm::vec3(0, 1, 0), open);
  double of_sky = 0.0;
  for (std::size_t i = 0; i < open.size(); ++i) of_sky += double{open[i] * rest.c[i].r} / of_sun;
  EXPECT_NEAR(of_sky * of_sun, 0.3, 0.03);

  Changes changes;
  std::vector<double> before, expected_before;
  for (int step = 0; step <= 360; ++step) {
    stage.environment.setTurn(static_cast<float>(step));
    const spec::RgbaImage image = pictureOf(stage, view);
    const glm::vec3 middle = stage.environment.keys()[0].direction;
    std::vector<double> now, expected;
    double sum = 0.0, expected_sum = 0.0;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
      const auto along = [](std::uint32_t k) {
        return kHalf * (2.0f * (static_cast<float>(k) + 0.5f) / kSide - 1.0f);
      };
      const glm::vec3 place(along(i % kSide), 0, along(i / kSide));
      if (std::max(std::abs(place.x), std::abs(place.z)) < kTower + 0.05f) continue;  // it, and its foot
      sum += now.emplace_back(double{image.texels[i].r} / of_sun);
      expected_sum += of_sky + expected.emplace_back(seenPastTower(disc, middle, place));
    }
    EXPECT_NEAR(sum / expected_sum, 1.0, 0.01) << "all of the light, at step " << step;
    for (std::size_t i = 0; i < before.size(); ++i)
      changes.add(now[i] - before[i], expected[i] - expected_before[i]);
    before = std::move(now), expected_before = std::move(expected);
  }
  EXPECT_EQ(changes.count, 360 * before.size());
  EXPECT_LT(changes.rms(), 0.012);
  // The sun's penumbra is seven steps wide. Where less of the disc is hidden than the blocker search
  // resolves, a pixel may change by up to a third of the sun's light in one step.
  EXPECT_NEAR(changes.expected_largest, 0.16, 0.01);
  EXPECT_LT(changes.largest, 2.4 * changes.expected_largest);
  EXPECT_LT(static_cast<double>(changes.far_off), 0.001 * static_cast<double>(changes.count));
}

}  // namespace lambent::frame
