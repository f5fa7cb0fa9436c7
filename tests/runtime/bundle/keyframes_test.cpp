// Compares animations at a point in time with closed forms.
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::gltf {
namespace {

using Path = AnimationChannel::Path;
using Interpolation = AnimationChannel::Interpolation;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

AnimationChannel channel(Path path, Interpolation interpolation, std::vector<float> times,
                         std::vector<float> values) {
  return {.node = 0,
          .path = path,
          .interpolation = interpolation,
          .times_s = std::move(times),
          .values = std::move(values)};
}

// Returns a rotation about +Y.
std::vector<float> turn(float degrees, float sign = 1.0f) {
  const float half = glm::radians(degrees) / 2.0f;
  return {0.0f, sign * std::sin(half), 0.0f, sign * std::cos(half)};
}
std::vector<float> operator+(std::vector<float> a, const std::vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Returns the direction to which a rotation takes +Z, in degrees about +Y.
float degreesOf(const glm::quat& q) {
  EXPECT_NEAR(glm::length(q), 1.0f, 1e-6f);
  const glm::vec3 there = q * glm::vec3(0, 0, 1);
  EXPECT_NEAR(there.y, 0.0f, 1e-6f);
  return glm::degrees(std::atan2(there.x, there.z));
}

TEST(Keyframes, StepsHoldTheirKey) {
  const auto c = channel(Path::Translation, Interpolation::Step, {1, 2, 4}, {1, 0, 0, 2, 0, 0, 4, 0, 0});
  for (const auto& [time, expected] : std::vector<std::pair<float, float>>{
           {0, 1}, {1, 1}, {1.999f, 1}, {2, 2}, {3.5f, 2}, {4, 4}, {100, 4}, {-5, 1}})
    EXPECT_EQ(vectorAt(c, time).x, expected) << time;
}

TEST(Keyframes, LinesRunEvenlyAndHoldBeyondTheirEnds) {
  const auto c =
      channel(Path::Scale, Interpolation::Linear, {0.5f, 1.5f, 3.5f}, {0, 1, 2, 4, 1, 0, 8, 3, -4});
  EXPECT_EQ(vectorAt(c, 0.0f), glm::vec3(0, 1, 2));
  EXPECT_EQ(vectorAt(c, 0.75f), glm::vec3(1, 1, 1.5f));
  EXPECT_EQ(vectorAt(c, 1.5f), glm::vec3(4, 1, 0));
  EXPECT_EQ(vectorAt(c, 2.5f), glm::vec3(6, 2, -2));
  EXPECT_EQ(vectorAt(c, 9.0f), glm::vec3(8, 3, -4));
}

TEST(Keyframes, RotationsTurnEvenlyTheShorterWay) {
  for (const float sign : {1.0f, -1.0f}) {  // q and -q are the same rotation
    const auto c = channel(Path::Rotation, Interpolation::Linear, {0, 2}, turn(10) + turn(130, sign));
    for (float time = 0.0f; time <= 2.0f; time += 0.125f)
      EXPECT_NEAR(degreesOf(rotationAt(c, time)), 10.0f + 60.0f * time, 1e-4f) << time;
  }
  const auto over = channel(Path::Rotation, Interpolation::Linear, {0, 1}, turn(-170) + turn(170));
  EXPECT_NEAR(degreesOf(rotationAt(over, 0.25f)), -175.0f, 1e-4f) << "by 20 degrees, not 340";
  const auto little = channel(Path::Rotation, Interpolation::Linear, {0, 1}, turn(20) + turn(20.00001f));
  EXPECT_NEAR(degreesOf(rotationAt(little, 0.5f)), 20.0f, 1e-4f);
}

// A cubic spline reproduces a cubic through its keys and slopes, for any interval lengths.
TEST(Keyframes, CubicSplinesReproduceCubics) {
  const auto value = [](double t) { return 1.0 + t * (2.0 + t * (-3.0 + 0.5 * t)); };
  const auto slope = [](double t) { return 2.0 + t * (-6.0 + 1.5 * t); };
  const std::vector<float> times = {0.0f, 0.5f, 3.0f, 4.0f};
  std::vector<float> values;
  for (const float t : times) {
    const auto v = static_cast<float>(value(double{t})), s = static_cast<float>(slope(double{t}));
    values = values + std::vector<float>{s, -s, 0, v, -v, 7, s, -s, 0};
  }
  const auto c = channel(Path::Translation, Interpolation::Cubic, times, values);
  for (double t = 0.0; t <= 4.0; t += 0.1) {
    const glm::vec3 at = vectorAt(c, static_cast<float>(t));
    EXPECT_NEAR(double{at.x}, value(t), 1e-5) << t;
    EXPECT_NEAR(double{at.y}, -value(t), 1e-5) << t;
    EXPECT_EQ(at.z, 7.0f);
  }
  EXPECT_EQ(vectorAt(c, 10.0f).x, static_cast<float>(value(4.0))) << "the last key, not its tangents";
}

TEST(Keyframes, HardTimesAreHarmless) {
  const auto one = channel(Path::Translation, Interpolation::Linear, {2}, {5, 6, 7});
  const auto one_cubic = channel(Path::Translation, Interpolation::Cubic, {2}, {9, 9, 9, 5, 6, 7, 9, 9, 9});
  for (const float time : {-1.0f, 0.0f, 2.0f, 3.0f, kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(vectorAt(one, time), glm::vec3(5, 6, 7));
    EXPECT_EQ(vectorAt(one_cubic, time), glm::vec3(5, 6, 7));
  }
  const auto two = channel(Path::Translation, Interpolation::Linear, {0, 1}, {0, 0, 0, 1, 0, 0});
  EXPECT_EQ(vectorAt(two, kNaN).x, 0.0f);
  EXPECT_EQ(vectorAt(two, kInfinity).x, 0.0f) << "counts as 0";
  // Equal times do not divide by zero: the later key counts from there.
  for (const auto way : {Interpolation::Step, Interpolation::Linear}) {
    const auto equal = channel(Path::Translation, way, {0, 1, 1, 2}, {0, 0, 0, 1, 0, 0, 5, 0, 0, 6, 0, 0});
    EXPECT_EQ(vectorAt(equal, 1.0f).x, 5.0f);
    EXPECT_TRUE(std::isfinite(vectorAt(equal, std::nextafter(1.0f, 0.0f)).x));
  }
  const auto empty = channel(Path::Rotation, Interpolation::Linear, {}, {});
  EXPECT_EQ(rotationAt(empty, 1.0f), glm::quat(1, 0, 0, 0));
  Trs parts{.translation = {1, 2, 3}};
  applyChannel(channel(Path::Translation, Interpolation::Linear, {}, {}), 1.0f, parts);
  EXPECT_EQ(parts.translation, glm::vec3(1, 2, 3)) << "nothing to say, nothing changes";
}

TEST(Keyframes, ChannelsReplaceTheirPartAndKeepTheOthers) {
  std::vector<Node> nodes(3);
  nodes[1].trs = Trs{.translation = {1, 2, 3}, .scale = glm::vec3(2.0f)};
  nodes[1].parent_from_node = nodes[1].trs->matrix();
  nodes[2].parent_from_node[3] = glm::vec4(9, 9, 9, 1);
  auto c = channel(Path::Rotation, Interpolation::Linear, {0, 1}, turn(0) + turn(90));
  c.node = 1;
  auto nowhere = c;
  nowhere.node = 2;  // no parts: not an animated node
  const Animation animation{.name = "turn", .channels = {c, nowhere}};
  EXPECT_EQ(durationOf(animation), 1.0f);
  EXPECT_EQ(durationOf(Animation{}), 0.0f);
  applyAnimations(std::vector{animation}, 1.0f, nodes);
  const glm::vec4 there = nodes[1].parent_from_node * glm::vec4(0, 0, 1, 1);
  EXPECT_LT(glm::distance(there, glm::vec4(3, 2, 3, 1)), 1e-5f);
  EXPECT_EQ(nodes[2].parent_from_node[3], glm::vec4(9, 9, 9, 1));
  EXPECT_EQ(nodes[0].parent_from_node, glm::mat4(1.0f));
}

}  // namespace
}  // namespace lambent::gltf
