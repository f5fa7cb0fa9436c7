// Compares matrices at points in free space with closed forms.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/light_change.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
#include "runtime/sh/basis.hpp"
#include "tests/support/neighborhood.hpp"

namespace lambent::baker {

namespace {

using testing::blackSphereChange;
using testing::ChangeMatrix;
using testing::icosphere;
using testing::irradianceOf;
using testing::matrixOf;
using testing::sceneOf;
using testing::Transport;

constexpr double kPi = std::numbers::pi;

// Bakes a ball of one colour as a body.
struct Ball : testing::BakedBody {
  explicit Ball(const glm::vec3& albedo) : BakedBody(icosphere({0, 0, 0}, 1.0f, 4), albedo) {}
};

// Returns points in many directions, at distances from near the surface to far away.
std::vector<glm::vec3> points() {
  std::vector<glm::vec3> out;
  for (const float distance : {1.01f, 1.1f, 1.3f, 2.0f, 4.0f, 8.0f})
    for (const glm::vec3 direction : {glm::vec3(0, 1, 0), {1, 0.1f, 0.2f}, {-1, 2, 0.5f}, {0.3f, -1, -1}})
      out.push_back(distance * glm::normalize(direction));
  return out;
}

TEST(PointChange, OfABlackSphereIsMinusTheCapThatItFills) {
  const Ball ball(glm::vec3(0.0f));
  const CapDirections directions(2048);
  for (const int order_out : {3, 5}) {
    const ChangeShape shape{.order = 5, .order_out = order_out, .channels = 0};
    PointChange point(ball.body, directions, shape);
    for (const glm::vec3& p : points()) {
      point.look(p);
      EXPECT_FALSE(point.inside());
      const ChangeMatrix truth = blackSphereChange(p, 1.0f, 5, order_out),
                         found = matrixOf(shape, point.visibility(), {});
      ChangeMatrix wrong = found;
      for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] -= truth[i];
      const double change = irradianceOf(truth, 5, order_out), error = irradianceOf(wrong, 5, order_out);
      EXPECT_LT(error, 0.005) << glm::length(p);
      // Rays are aimed at the body, so distance does not matter.
      EXPECT_LT(error, 0.01 * change) << glm::length(p);
    }
  }
}

TEST(PointChange, MetersWhatTheMatrixDoesToIrradiance) {
  const Ball ball(glm::vec3(0.9f, 0.5f, 0.1f));
  ASSERT_EQ(ball.body.channels(), 3u);
  const CapDirections directions(512);
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 3};
  PointChange point(ball.body, directions, shape);
  point.look({1.2f, 0.6f, -0.4f});
  double square = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    square += std::pow(irradianceOf(matrixOf(shape, point.visibility(), point.bounced(), c), 5, 3), 2) / 3.0;
  EXPECT_NEAR(ChangeMeter(shape).measure(point.visibility(), point.bounced()), std::sqrt(square), 1e-5);
}

TEST(PointChange, LeavesUniformLightAsItIsBesideAWhiteBody) {
  const Ball ball(glm::vec3(1.0f));
  ASSERT_EQ(ball.body.channels(), 1u);
  const CapDirections directions(2048);
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 1};
  PointChange point(ball.body, directions, shape);
  for (const glm::vec3& p : points()) {
    point.look(p);
    const ChangeMatrix matrix = matrixOf(shape, point.visibility(), point.bounced());
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(matrix[i * 25], 0.0f, 2e-3f) << i;
  }
}

TEST(PointChange, ReflectsEachColourByItself) {
  const glm::vec3 albedo(0.9f, 0.5f, 0.0f);
  const Ball colored(albedo), white(glm::vec3(1.0f));
  const CapDirections directions(512);
  const ChangeShape grey{.order = 5, .order_out = 3, .channels = 1};
  const ChangeShape rgb{.order = 5, .order_out = 3, .channels = 3};
  PointChange of_colored(colored.body, directions, rgb), of_white(white.body, directions, grey);
  for (const glm::vec3& p : points()) {
    of_colored.look(p), of_white.look(p);
    // A convex body does not light itself: what leaves it goes with its albedo.
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < 9 * 25; ++i)
        EXPECT_NEAR(of_colored.bounced()[c * 9 * 25 + i], albedo[static_cast<int>(c)] * of_white.bounced()[i],
                    1e-3f);
  }
}

TEST(PointChange, KnowsPointsInsideABodyByItsBacks) {
  const Ball ball(glm::vec3(0.0f));
  const CapDirections directions(256);
  PointChange point(ball.body, directions, {.order = 5, .order_out = 3, .channels = 0});
  for (const glm::vec3 p : {glm::vec3(0.0f), glm::vec3(0.9f, 0.1f, 0.0f)}) {
    point.look(p);
    EXPECT_TRUE(point.inside());
    EXPECT_NEAR(glm::length(point.nearestPoint()), 1.0f, 2e-3f);
    EXPECT_GT(glm::dot(point.nearestNormal(), glm::normalize(point.nearestPoint())), 0.99f);
    // All is blocked: M = 0.
    EXPECT_NEAR(point.visibility()[0], -std::sqrt(4.0 * kPi), 1e-4);
  }
}

// Tests how strongly receivers see a change, depending on their normals.

// Returns V - 1 of a small black body in one direction.
std::vector<float> blackIn(const glm::vec3& direction, const ChangeShape& shape, float steradians) {
  std::vector<float> visibility(shape.visibilitySize());
  sh::evaluate(shape.visibilityBands(), direction, visibility);
  for (float& v : visibility) v *= -steradians;
  return visibility;
}

FacingArea facing(const glm::vec3& normal) {
  FacingArea area{};
  addFacing(area, normal, 3.0f);
  return area;
}

TEST(ReceiverMeter, OfReceiversThatFaceAnywhereIsTheChangeMeter) {
  for (const int outputs : {3, 5}) {
    const ChangeShape shape{.order = 5, .order_out = outputs, .channels = 0};
    FacingArea anywhere{};
    addFacingAnywhere(anywhere, 5.0f);
    const auto change = blackIn(glm::normalize(glm::vec3(1, 2, -1)), shape, 0.2f);
    const double measured = ReceiverMeter(shape, anywhere).measure(change, {});
    EXPECT_DOUBLE_EQ(measured, ReceiverMeter(shape, {}).measure(change, {}));
    // ChangeMeter also weights a fifth band, or all bands.
    if (outputs == 3) {
      EXPECT_NEAR(measured / ChangeMeter(shape).measure(change, {}), 1.0, 0.02);
    }
  }
}

TEST(ReceiverMeter, FallsWithTheCosine) {
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 0};
  const ReceiverMeter floor(shape, facing({0, 1, 0}));
  const auto seen = [&](float height) {
    return floor.measure(blackIn(glm::normalize(glm::vec3(1.0f, height, 0.0f)), shape, 0.1f), {});
  };
  EXPECT_GT(seen(1.0f), 2.0 * seen(0.2f));
  // The weight has three bands of the clamped cosine: it is not quite 0 for a body on the horizon or below.
  EXPECT_LT(seen(0.0f), 0.2 * seen(1.0f));
  EXPECT_LT(seen(-1.0f), 0.1 * seen(1.0f));
  // Light that the body emits counts the same.
  const ChangeShape sends{.order = 5, .order_out = 3, .channels = 1};
  std::vector<float> bounced(sends.bouncedSize(), 0.0f);
  std::vector<float> y(9);
  sh::evaluate(3, glm::vec3(0, 1, 0), std::span<float>(y));
  for (std::size_t i = 0; i < 9; ++i) bounced[i * sends.columns()] = 0.1f * y[i];
  const std::vector<float> open(sends.visibilitySize(), 0.0f);
  EXPECT_GT(ReceiverMeter(sends, facing({0, 1, 0})).measure(open, bounced),
            10.0 * ReceiverMeter(sends, facing({0, -1, 0})).measure(open, bounced));
}

}  // namespace
}  // namespace lambent::baker
