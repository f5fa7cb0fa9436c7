// Tests volumes as bodies, with a synthetic medium.
#include "baker/effects/neighborhood/bodies.hpp"
#include "tests/support/neighborhood.hpp"

namespace lambent::baker {
namespace {

using testing::ChangeMatrix;
using testing::irradianceOf;
using testing::matrixOf;

// Makes a homogeneous ball of radius 1 about the origin. It stops light, and sends `glow` times the stopped
// fraction, in band 0 alone.
VolumeBody fogBody(double extinction, float glow) {
  const auto march = [=](const glm::vec3& origin, const glm::vec3& direction, float t_max,
                         std::span<float> scattered) {
    const double along = -glm::dot(glm::dvec3(origin), glm::dvec3(direction));
    const double off2 = glm::dot(glm::dvec3(origin), glm::dvec3(origin)) - along * along;
    std::fill(scattered.begin(), scattered.end(), 0.0f);
    if (off2 >= 1.0) return 1.0f;
    const double half = std::sqrt(1.0 - off2);
    const double length = std::max(0.0, std::min(along + half, double{t_max}) - std::max(along - half, 0.0));
    const double through = std::exp(-extinction * length);
    for (std::size_t c = 0; c < 3; ++c)
      scattered[c * 25] = glow * static_cast<float>((1.0 - through) * 0.5 / std::sqrt(std::numbers::pi));
    return static_cast<float>(through);
  };
  return VolumeBody(march, /*order=*/5, glm::vec3(-1.0f), glm::vec3(1.0f));
}

TEST(VolumeBody, OfGreatDensityIsTheBlackSphere) {
  const VolumeBody body = fogBody(1e6, 0.0f);
  const CapDirections directions(4096);
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 0};
  PointChange point(body, directions, shape);
  for (const glm::vec3 p : {glm::vec3(2, 0, 0), {0.5f, -1.2f, 0.3f}, {4, 4, 1}}) {
    point.look(p);
    ChangeMatrix wrong = matrixOf(shape, point.visibility(), {});
    const ChangeMatrix truth = testing::blackSphereChange(p, 1.0f, 5, 3);
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] -= truth[i];
    EXPECT_LT(irradianceOf(wrong, 5, 3), 0.01 * irradianceOf(truth, 5, 3));
  }
}

TEST(VolumeBody, LetsThroughAtItsMiddleWhatBeerAndLambertSay) {
  for (const double extinction : {0.0, 1e-6, 1.0, 4.0}) {
    const VolumeBody body = fogBody(extinction, 0.0f);
    const CapDirections directions(8192);
    PointChange point(body, directions, {.order = 5, .order_out = 3, .channels = 0});
    point.look(glm::vec3(0.0f));
    EXPECT_FALSE(point.inside());
    // Literature 7.8: transmittance from the middle is exp(-sigma) in all directions.
    const double root = std::sqrt(4.0 * std::numbers::pi);
    EXPECT_NEAR(point.visibility()[0], root * (std::exp(-extinction) - 1.0), 1e-5);
    for (std::size_t i = 1; i < point.visibility().size(); ++i)
      EXPECT_NEAR(point.visibility()[i], 0.0f, 2e-3f);
  }
}

TEST(VolumeBody, ThatSendsAllThatItStopsLeavesUniformLightAsItIs) {
  const VolumeBody body = fogBody(2.0, 1.0f);
  const CapDirections directions(1024);
  const ChangeShape shape{.order = 5, .order_out = 3, .channels = 3};
  PointChange point(body, directions, shape);
  for (const glm::vec3 p : {glm::vec3(0, 0, 0), {1.2f, 0, 0}, {3, -1, 2}}) {
    point.look(p);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChangeMatrix matrix = matrixOf(shape, point.visibility(), point.bounced(), c);
      for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(matrix[i * 25], 0.0f, 1e-5f);
    }
  }
}

}  // namespace
}  // namespace lambent::baker
