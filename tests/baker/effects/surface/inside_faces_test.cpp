// Tests bounces that are also gathered inside faces, and vertex values that are fitted to them.
#include "baker/effects/surface/inside_faces.hpp"

#include <algorithm>

#include "baker/jobs/parallel.hpp"
#include "tests/support/glossy_transport.hpp"

namespace lambent::baker {
namespace {

using testing::bakeGlossy;
using testing::Fit;
using testing::flipped;
using testing::GlossyBake;
using testing::glossyScene;
using testing::grid;
using testing::icosphere;
using testing::lambertKernels;
using testing::Transport;
using testing::uniformRadiance;

// Makes a floor and a ceiling of n x n cells each, open at the sides.
Scene slot(int n) {
  return glossyScene({grid({0, 0, 0}, 1.0f, n), flipped(grid({0, 0.4f, 0}, 1.0f, n))});
}

// Compares bounced light at samples of `fine` with interpolation over the faces of `coarse`: relative RMS.
// Both have `width` values per sample.
double error(const Transport& coarse, const std::vector<float>& values, const Transport& fine,
             const std::vector<float>& truth, std::size_t width) {
  double wrong = 0.0, all = 0.0;
  for (std::size_t s = 0; s < fine.samples.size(); ++s) {
    const glm::vec3 at = fine.samples.positions[s];
    for (const glm::uvec3& t : coarse.geometry.triangles) {
      const glm::vec3 a = coarse.geometry.positions[t.x], b = coarse.geometry.positions[t.y],
                      c = coarse.geometry.positions[t.z], across = glm::cross(b - a, c - a);
      const float area = glm::dot(across, across);
      if (coarse.geometry.normals[t.x] != fine.samples.normals[s]) continue;
      const glm::vec3 shares(glm::dot(across, glm::cross(b - at, c - at)) / area,
                             glm::dot(across, glm::cross(c - at, a - at)) / area,
                             glm::dot(across, glm::cross(a - at, b - at)) / area);
      if (std::min({shares.x, shares.y, shares.z}) < -1e-4f) continue;
      for (std::size_t i = 0; i < width; ++i) {
        double shown = 0.0;
        for (int k = 0; k < 3; ++k)
          shown += double{shares[k]} * double{values[coarse.samples.vertex_sample[t[k]] * width + i]};
        const double is = truth[s * width + i];
        wrong += (shown - is) * (shown - is), all += is * is;
      }
      break;
    }
  }
  return std::sqrt(wrong / all);
}

TEST(GlossyInsideFaces, ABounceFittedThereIsThatOfAFinerMeshMoreThanWhatTheVerticesSee) {
  const Transport coarse(slot(5), true), fine(slot(40), true);
  const auto baked = [](const Transport& t, Fit fit) {
    return bakeGlossy(t, lambertKernels(t), {.rays = 1024, .bounces = 1, .fit = fit}).direct.glossy.bounced;
  };
  const std::vector<float> truth = baked(fine, Fit::Nothing);
  const double without = error(coarse, baked(coarse, Fit::DirectLight), fine, truth, 625),
               with = error(coarse, baked(coarse, Fit::AllLight), fine, truth, 625);
  RecordProperty("without", std::to_string(without));
  RecordProperty("with", std::to_string(with));
  EXPECT_LT(with, 0.75 * without);
}

TEST(GlossyInsideFaces, OfAWhiteFurnaceLeaveUniformLightAsItIs) {
  // Everything is white, beside and above a white floor: no uniform light is lost.
  const Transport t(glossyScene({icosphere({0.3f, 0.1f, 0.1f}, 0.3f, 2), grid({0, -0.5f, 0}, 2.0f, 8)}),
                    true);
  const auto baked = bakeGlossy(t, lambertKernels(t),
                                {.order = 4, .rays = 256, .bounces = kMostBounces, .fit = Fit::AllLight});
  const GlossyField& field = baked.direct.glossy;
  for (std::size_t s = 0; s < field.size(); ++s) {
    if (t.samples.originsOf(s).empty()) continue;
    EXPECT_NEAR(uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s)), 1.0f,
                1.2e-2f);  // what passes on between patches is not fitted
  }
}

TEST(GlossyInsideFaces, GiveTheSameLightForAnyMemoryAndNumberOfThreads) {
  Scene scene = slot(8);
  testing::ownMaterial(scene, 1).metallic = 0.0f;  // the ceiling is matte
  testing::addPointLight(scene, {0.1f, 0.2f, 0.1f});
  const Transport t(scene, true);
  const auto baked = [&](std::size_t memory) {
    return bakeGlossy(
        t, lambertKernels(t),
        {.exit_order = 7, .rays = 128, .bounces = 3, .hit_memory = memory, .fit = Fit::AllLight});
  };
  const GlossyBake all = baked(std::size_t{1} << 30);
  EXPECT_GT(all.hits_inside, 0u);
  EXPECT_GT(all.direct.of(SurfacePart::Matte).hits.bytes(), 0u);
  const auto expectSame = [&](const GlossyBake& again) {
    EXPECT_EQ(again.direct.glossy.visibility, all.direct.glossy.visibility);
    EXPECT_EQ(again.direct.glossy.lights_full, all.direct.glossy.lights_full);
    EXPECT_EQ(again.direct.glossy.bounced, all.direct.glossy.bounced);
    EXPECT_EQ(again.direct.field.vectors, all.direct.field.vectors);
    EXPECT_EQ(again.bounced.field.vectors, all.bounced.field.vectors);
  };
  // The memory suffices for the vertices' hits and some of the points', or for none.
  for (const std::size_t memory : {all.hitBytes() + all.hits_inside / 2, std::size_t{0}}) {
    const GlossyBake again = baked(memory);
    EXPECT_LE(again.hitBytes() + again.hits_inside, memory);
    expectSame(again);
  }
  withThreads(1, [&] { expectSame(baked(std::size_t{1} << 30)); });
}

}  // namespace
}  // namespace lambent::baker
