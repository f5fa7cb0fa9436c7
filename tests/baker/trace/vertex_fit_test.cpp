#include "baker/trace/vertex_fit.hpp"

#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "baker/jobs/parallel.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::Transport;
using Function = std::function<float(const glm::vec3&)>;

// Holds a function over the samples of a scene, before and after it is fitted at the centroids of all
// triangles that `wanted` names.
class Fitted {
 public:
  Fitted(const Transport& t, const Function& f,
         const std::function<bool(const glm::vec3& centroid)>& wanted = {}, unsigned threads = 0)
      : t_(t), f_(f) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < t.geometry.triangles.size(); ++i)
      if (!wanted || wanted(place(i, glm::vec3(1.0f / 3.0f)))) triangles.push_back(i);
    points = facePoints(t.geometry, t.samples, triangles);
    for (const glm::vec3& position : t.samples.positions) before.push_back(f(position));
    std::vector<float> at_points;
    for (const glm::vec3& position : points.samples.positions) at_points.push_back(f(position));
    valid.assign(points.samples.size(), 1);
    after = before;
    const VertexFit fit(t.geometry, t.samples, {0, t.samples.size()}, points, {0, points.samples.size()},
                        valid);
    withThreads(threads, [&] { EXPECT_TRUE(fit.apply(1, at_points, after, {})); });
  }

  // Returns the root of the integral of the squared interpolation error.
  double error(const std::vector<float>& values) const {
    double sum = 0.0;
    constexpr int kParts = 8;
    for (std::uint32_t i = 0; i < t_.geometry.triangles.size(); ++i)
      for (int a = 0; a < kParts; ++a)
        for (int b = 0; a + b < kParts; ++b) {
          const float u = (static_cast<float>(a) + 1.0f / 3.0f) / kParts,
                      v = (static_cast<float>(b) + 1.0f / 3.0f) / kParts;
          const glm::vec3 shares(1.0f - u - v, u, v);
          double shown = 0.0;
          for (int c = 0; c < 3; ++c)
            shown +=
                double{shares[c]} * double{values[t_.samples.vertex_sample[t_.geometry.triangles[i][c]]]};
          const double off = shown - double{f_(place(i, shares))};
          sum += off * off;
        }
    return std::sqrt(sum / static_cast<double>(t_.geometry.triangles.size()));
  }

  FacePoints points;
  std::vector<std::uint8_t> valid;
  std::vector<float> before, after;

 private:
  glm::vec3 place(std::uint32_t triangle, const glm::vec3& shares) const {
    glm::vec3 sum(0.0f);
    for (int c = 0; c < 3; ++c) sum += shares[c] * t_.geometry.positions[t_.geometry.triangles[triangle][c]];
    return sum;
  }
  const Transport& t_;
  Function f_;
};

TEST(VertexFit, LeavesConstantAndLinearFunctionsAsTheyAre) {
  const Transport t(testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 2.0f, 12)}));
  const Fitted fitted(t, [](const glm::vec3& p) { return 3.0f + 2.0f * p.x - p.z; });
  for (std::size_t s = 0; s < fitted.after.size(); ++s) EXPECT_NEAR(fitted.after[s], fitted.before[s], 2e-6f);
}

TEST(VertexFit, OfAParabolaErrsByLessThanHalfOfWhatInterpolationDoes) {
  // In one dimension the best line errs by 1/(12 sqrt 5), interpolation by 1/(2 sqrt 30) of f'' h²: 0.41.
  const Transport t(testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 2.0f, 16)}));
  const Fitted fitted(t, [](const glm::vec3& p) { return p.x * p.x + p.z * p.z; });
  EXPECT_LT(fitted.error(fitted.after), 0.5 * fitted.error(fitted.before));
}

TEST(VertexFit, OfAShadowsEdgeErrsLessThanInterpolationWhereverItFalls) {
  const Transport t(testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 2.0f, 16)}));
  for (const float at : {-0.31f, -0.02f, 0.055f, 0.27f}) {
    const Fitted fitted(
        t, [at](const glm::vec3& p) { return 1.0f / (1.0f + std::exp(-20.0f * (p.x + 0.3f * p.z - at))); });
    EXPECT_LT(fitted.error(fitted.after), 0.75 * fitted.error(fitted.before)) << at;
  }
}

TEST(VertexFit, TakesNoNoticeOfPointsThatNobodySees) {
  const Transport t(testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 2.0f, 4)}));
  Fitted fitted(t, [](const glm::vec3& p) { return p.x * p.x; });
  std::fill(fitted.valid.begin(), fitted.valid.end(), std::uint8_t{0});
  const VertexFit fit(t.geometry, t.samples, {0, t.samples.size()}, fitted.points,
                      {0, fitted.points.samples.size()}, fitted.valid);
  std::vector<float> values = fitted.before;
  const std::vector<float> wild(fitted.points.samples.size(), 1e6f);
  ASSERT_TRUE(fit.apply(1, wild, values, {}));
  EXPECT_EQ(values, fitted.before);
}

TEST(ChangingTriangles, AreNoneWhereAllCornersSeeTheSame) {
  const Transport t(testing::sceneOf({testing::icosphere({0.0f, 0.0f, 0.0f}, 1.0f, 2)}));
  const std::vector<float> same(2 * t.samples.size(), 0.7f);
  EXPECT_TRUE(changingTriangles(t.geometry, t.samples, {0, t.samples.size()}, 2, same).empty());
}

TEST(ChangingTriangles, AreThoseAcrossAStep) {
  const Transport t(testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 2.0f, 8)}));
  std::vector<float> step;
  for (const glm::vec3& p : t.samples.positions) step.push_back(p.x > 0.1f ? 1.0f : 0.0f);
  const auto found = changingTriangles(t.geometry, t.samples, {0, t.samples.size()}, 1, step);
  ASSERT_FALSE(found.empty());
  for (const std::uint32_t i : found) {
    float least = 1.0f, most = -1.0f;
    for (int c = 0; c < 3; ++c) {
      const float x = t.geometry.positions[t.geometry.triangles[i][c]].x;
      least = testing::smaller(least, x), most = testing::larger(most, x);
    }
    EXPECT_LT(least, 0.1f);
    EXPECT_GT(most, 0.1f);
  }
  EXPECT_LE(found.size(), 16u);
}

}  // namespace
}  // namespace lambent::baker
