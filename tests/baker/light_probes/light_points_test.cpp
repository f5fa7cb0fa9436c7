#include <algorithm>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/light_probes/light_probes.hpp"

namespace lambent::baker {
namespace {

std::vector<glm::vec3> cloud(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  std::vector<glm::vec3> points(count);
  for (glm::vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

double meanSquare(const std::vector<glm::vec3>& points, const std::vector<glm::vec3>& centres) {
  double sum = 0.0;
  for (const glm::vec3& p : points) {
    double least = 1e30;
    for (const glm::vec3& c : centres) least = std::min(least, double{glm::dot(p - c, p - c)});
    sum += least;
  }
  return sum / static_cast<double>(points.size());
}

TEST(LightPoints, FindTheMiddlesOfFarClusters) {
  std::vector<glm::vec3> points;
  for (const glm::vec3& middle : {glm::vec3(0, 0, 0), {10, 0, 0}, {0, 10, 0}, {0, 0, 10}})
    for (const glm::vec3& p : cloud(200)) points.push_back(middle + 0.5f * p);
  const auto found = lightPoints(points, std::vector<float>(points.size(), 1.0f), 4);
  ASSERT_EQ(found.size(), 4u);
  for (const glm::vec3& middle : {glm::vec3(0, 0, 0), {10, 0, 0}, {0, 10, 0}, {0, 0, 10}})
    EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                            [&](const glm::vec3& p) { return glm::distance(p, middle) < 0.2f; }));
}

TEST(LightPoints, LieNearerTheMoreThereAre) {
  const auto points = cloud(2000);
  const std::vector<float> areas(points.size(), 1.0f);
  double before = 1e30;
  for (const std::size_t count : {1u, 4u, 8u, 16u, 32u}) {
    const auto found = lightPoints(points, areas, count);
    EXPECT_EQ(found.size(), count);
    const double here = meanSquare(points, found);
    EXPECT_LT(here, before) << count;
    before = here;
  }
  // If each of 32 light probes has an equal part of the cube's 8 m³, the mean square distance is at least
  // that of a ball of this volume, 3/5 r².
  EXPECT_LT(before, 1.4 * 0.6 * std::pow(8.0 / 32 * 0.75 / 3.14159, 2.0 / 3.0));
}

TEST(LightPoints, IgnoreWhatHasNoAreaUnlessNothingHas) {
  const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {50, 0, 0}};
  EXPECT_EQ(lightPoints(points, std::vector{1.0f, 1.0f, 0.0f}, 8).size(), 2u);
  EXPECT_EQ(lightPoints(points, std::vector{0.0f, 0.0f, 0.0f}, 8).size(), 3u);
}

TEST(MergePoints, LeavesOneOfThoseThatCoincide) {
  std::vector<glm::vec3> points = {{1, 0, 0}, {0, 0, 0}, {1, 1e-4f, 0}, {1, 5, 0}, {0, 0, 1e-4f}};
  mergePoints(points, 1e-3f);
  EXPECT_EQ(points, (std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 0}, {1, 5, 0}}));
}

}  // namespace
}  // namespace lambent::baker
