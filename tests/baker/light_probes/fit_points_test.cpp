#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/light_probes/light_probes.hpp"
#include "baker/transport/face_points.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::Transport;

constexpr double kFitTolerance = 1e-6;
constexpr float kDepth = 0.01f;

struct Fitted {
  Transport transport;
  std::vector<float> areas;
  std::vector<glm::vec3> means, points;

  Fitted(const bundle::MeshData& mesh, std::size_t count)
      : transport(testing::sceneOf({mesh})),
        areas(sampleAreas(transport.geometry, transport.samples)),
        means(lightPoints(transport.samples.positions, areas, count)),
        points(means) {
    fitPoints(points, transport.samples, areas, kFitTolerance, kDepth);
  }
};

// Returns the root mean square distance between places and the places that their blends represent.
double missed(const Fitted& fit, const std::vector<glm::vec3>& points) {
  double sum = 0.0, areas = 0.0;
  for (std::size_t i = 0; i < fit.areas.size(); ++i) {
    const glm::vec3 place = fit.transport.samples.positions[i];
    const BlendWeights weights = blendWeights(place, points, kFitTolerance);
    glm::dvec3 away = -glm::dvec3(place);
    for (std::size_t k = 0; k < 4; ++k) away += weights.weight[k] * glm::dvec3(points[weights.light[k]]);
    sum += double{fit.areas[i]} * glm::dot(away, away);
    areas += double{fit.areas[i]};
  }
  return std::sqrt(sum / areas);
}

TEST(FitPoints, BringsBlendsNearerToTheSurface) {
  for (const std::size_t count : {4u, 8u, 16u, 32u}) {
    const Fitted ball(testing::icosphere({0, 0, 0}, 1.0f, 4), count);
    EXPECT_LT(missed(ball, ball.points), (count == 4 ? 0.96 : 0.85) * missed(ball, ball.means)) << count;
    const Fitted box(testing::box({0, 0, 0}, {2, 1, 1}, 24), count);
    EXPECT_LT(missed(box, box.points), (count == 4 ? 0.96 : 0.85) * missed(box, box.means)) << count;
  }
}

TEST(FitPoints, LeavesThemInsideTheBody) {
  for (const std::size_t count : {4u, 8u, 16u, 32u}) {
    for (const glm::vec3& point : Fitted(testing::icosphere({0, 0, 0}, 1.0f, 4), count).points)
      EXPECT_LT(glm::length(point), 1.0f - 0.9f * kDepth);
    for (const glm::vec3& point : Fitted(testing::box({0, 0, 0}, {2, 1, 1}, 24), count).points)
      EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(point), glm::vec3(1, 0.5f, 0.5f) + 1e-5f)))
          << point.x << " " << point.y << " " << point.z;
  }
}

TEST(FitPoints, OfFewOrCoincidentPointsStayFinite) {
  const Fitted ball(testing::icosphere({0, 0, 0}, 1.0f, 2), 1);
  EXPECT_LT(glm::length(ball.points[0]), 1e-3f);
  std::vector<glm::vec3> same(3, glm::vec3(0.5f, 0, 0));
  fitPoints(same, ball.transport.samples, ball.areas, 0.0, kDepth);
  for (const glm::vec3& point : same) EXPECT_LT(glm::length(point), 1.0f);
  fitPoints(same, ball.transport.samples, std::vector<float>(ball.areas.size(), 0.0f), 0.0, 0.0f);
  for (const glm::vec3& point : same) EXPECT_LT(glm::length(point), 1.0f + 1e-5f);
  SampleSet dot;
  dot.positions = {{1, 2, 3}};
  dot.cells = {{0, 1, {1, 2, 3}, {1, 2, 3}}};
  std::vector<glm::vec3> one = {{0, 0, 0}};
  fitPoints(one, dot, std::vector{1.0f}, 0.0, kDepth);
  EXPECT_LT(glm::distance(one[0], dot.positions[0]), 1e-5f);
}

}  // namespace
}  // namespace lambent::baker
