#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/gather.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/transport/samples.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glossy_transport.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {

namespace {

using testing::Transport;

// Makes a box on a coarse floor, diffuse or of metal.
Scene boxOnCoarseFloor(float metallic) {
  Scene scene = testing::sceneOf({testing::grid({0.0f, 0.0f, 0.0f}, 4.0f, 10),
                                  testing::box({0.13f, 0.4f, -0.21f}, {0.7f, 0.8f, 0.7f}, 3)});
  scene.materials[0].metallic = metallic;
  scene.materials[0].roughness = metallic > 0.0f ? 0.3f : 1.0f;
  return scene;
}

// Measures the relative error of interpolating over the samples, at points of faces that the fit did not use:
// root mean square, weighted by area.
class Truth {
 public:
  explicit Truth(const Transport& t) : t_(t) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform;
    for (std::uint32_t i = 0; i < t.geometry.triangles.size(); ++i) {
      const float root = std::sqrt(uniform(random)), along = uniform(random);
      const glm::vec3 shares(1.0f - root, root * (1.0f - along), root * along);
      const glm::uvec3 corners = t.geometry.triangles[i];
      const FacePoint point = facePoint(t.geometry, corners, shares);
      shares_.push_back(shares);
      areas_.push_back(triangleArea(t.geometry, corners));
      points.positions.push_back(point.position);
      points.normals.push_back(point.normal);
      points.origins.push_back(point.origin);
    }
    for (std::uint32_t i = 0; i <= points.size(); ++i) points.origin_offsets.push_back(i);
    const bool glossy = t.samples.glossy.begin == 0;
    (glossy ? points.glossy : points.diffuse) = SampleStretch{0, points.size()};
    if (!glossy) points.normal_mapped = points.glossy = {points.size(), points.size()};
  }

  double error(std::size_t width, std::span<const float> truth, const std::vector<std::uint8_t>& valid,
               std::span<const float> samples) const {
    double wrong = 0.0, all = 0.0;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      if (valid[i] == 0) continue;
      for (std::size_t k = 0; k < width; ++k) {
        double shown = 0.0;
        for (int c = 0; c < 3; ++c)
          shown += double{shares_[i][c]} *
                   double{samples[t_.samples.vertex_sample[t_.geometry.triangles[i][c]] * width + k]};
        const double is = truth[i * width + k];
        wrong += areas_[i] * (shown - is) * (shown - is);
        all += areas_[i] * is * is;
      }
    }
    return std::sqrt(wrong / all);
  }

  SampleSet points;

 private:
  const Transport& t_;
  std::vector<glm::vec3> shares_;
  std::vector<double> areas_;
};

constexpr std::size_t kRays = 1024, kTrueRays = 4096;

TEST(FitVertices, ShowsVisibilityOverFacesOfMetalBetterThanWhatTheVerticesSee) {
  const Transport t(boxOnCoarseFloor(1.0f), /*with_glossy=*/true);
  ASSERT_EQ(t.samples.glossy.begin, 0u);
  const Truth truth(t);
  Progress progress;
  const auto there =
      bakeDirect(DirectPass(t.diffuse().withSamples(truth.points), {.rays = kTrueRays}), {progress});

  const auto bakeFitted = [&](unsigned threads) {
    std::pair<GlossyField, GlossyField> out;
    withThreads(threads, [&] {
      const DirectPass pass(t.diffuse(), {.rays = kRays});
      auto direct = bakeDirect(pass, {progress});
      out.first = direct->glossy;
      std::unique_ptr<InsideFaces> inside;
      ASSERT_TRUE(fitInsideFaces(pass, SurfacePart::Glossy, {progress}, *direct, inside));
      ASSERT_TRUE(inside);
      EXPECT_GT(inside->points().size(), 0u);
      EXPECT_LT(inside->points().size(), t.geometry.triangles.size());  // far from the box all see the same
      out.second = direct->glossy;
    });
    return out;
  };
  const auto [before, after] = bakeFitted(0);
  const auto errorOf = [&](const GlossyField& field) {
    return truth.error(field.visibilitySize(), there->glossy.visibility, there->looks.valid,
                       field.visibility);
  };
  EXPECT_LT(errorOf(after), 0.9 * errorOf(before));
  EXPECT_EQ(bakeFitted(1).second.visibility, after.visibility);
}

TEST(FitVertices, ShowsBouncedLightOverMatteFacesBetterThanWhatTheVerticesReceive) {
  const Transport t(boxOnCoarseFloor(0.0f));
  const Truth truth(t);
  Progress progress;
  const DirectPass pass(t.diffuse(), {.rays = kRays, .keep_hits = true, .hit_memory = 1u << 30});
  auto direct = bakeDirect(pass, {progress});
  std::unique_ptr<InsideFaces> inside;
  ASSERT_TRUE(fitInsideFaces(pass, SurfacePart::Matte, {progress}, *direct, inside));
  ASSERT_TRUE(inside);
  const DirectPass true_pass(t.diffuse().withSamples(truth.points),
                             {.rays = kTrueRays, .keep_hits = true, .hit_memory = 1u << 30});
  const auto there = bakeDirect(true_pass, {progress});
  const ExitRadiance exit(t.geometry, t.samples, nullptr);
  TransferField truly = there->field.zeros(truth.points.size()), mapped = there->mapped;
  for (std::size_t s = 0; s < truth.points.size(); s += kSamplesGathered)
    BounceGather(true_pass, *there, exit)
        .matte({.number = 1, .thinly = false, .exit = exit, .before = direct->field}, s,
               std::min(s + kSamplesGathered, truth.points.size()), truly, mapped);
  const auto bounced = [&](unsigned threads, const InsideFaces* fitted) {
    std::optional<BounceResult> result;
    withThreads(threads, [&] {
      result = bakeBounces({.pass = pass, .direct = *direct, .fits = {fitted, nullptr}}, {.bounces = 1},
                           {progress});
    });
    return std::move(result->field.vectors);
  };
  const auto error = [&](const std::vector<float>& vectors) {
    return truth.error(direct->field.vectorSize(), truly.vectors, there->looks.valid, vectors);
  };
  const std::vector<float> fitted = bounced(0, inside.get());
  EXPECT_EQ(bounced(1, inside.get()), fitted);
  EXPECT_LT(error(fitted), 0.9 * error(bounced(0, nullptr)));
}

TEST(FitVertices, LeavesAnOpenBodyOfMetalAsItIsAndTracesNothing) {
  Scene scene = testing::sceneOf({testing::icosphere({0.0f, 0.0f, 0.0f}, 1.0f, 3)});
  scene.materials[0].metallic = 1.0f;
  scene.materials[0].roughness = 0.3f;
  const Transport t(scene, /*with_glossy=*/true);
  const DirectPass pass(t.diffuse(), {.rays = 256});
  Progress progress;
  auto direct = bakeDirect(pass, {progress});
  const std::vector<float> before = direct->glossy.visibility;
  std::unique_ptr<InsideFaces> inside;
  ASSERT_TRUE(fitInsideFaces(pass, SurfacePart::Glossy, {progress}, *direct, inside));
  EXPECT_EQ(direct->glossy.visibility, before);
  EXPECT_FALSE(inside);
}

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
