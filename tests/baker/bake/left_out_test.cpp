// Tests that what a plan leaves out is not missed: with everything forced on the bundle shows the same.
#include <cmath>

#include <gtest/gtest.h>

#include "baker/bake/bake.hpp"
#include "tests/support/decoded_bundle.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {
namespace {

using testing::DecodedDraw;

struct Baked {
  BakeReport report;
  std::vector<DecodedDraw> draws;
};

class LeftOut : public ::testing::Test {
 protected:
  Baked bakeWith(const Scene& scene, const std::string& effects) const {
    Progress progress;
    const auto output = folder_.path() / (effects + ".lmb.glb");
    const BakeOptions options{.quality = Quality::Draft, .error_bound = 1e-4f, .effects = effects};
    auto report = bake(scene, options, output, {progress});
    EXPECT_TRUE(report) << report.error().line();
    auto draws = testing::decodeBundle(output);
    EXPECT_TRUE(draws) << draws.error().line();
    return {std::move(*report), std::move(*draws)};
  }

 private:
  testing::TemporaryFolder folder_;
};

// Relative RMS of transfer at vertices; refinement must not have added any.
double difference(const Baked& a, const Baked& b) {
  double square = 0.0, all = 0.0;
  EXPECT_EQ(a.draws.size(), b.draws.size());
  for (std::size_t d = 0; d < a.draws.size(); ++d) {
    EXPECT_EQ(a.draws[d].transfer.size(), b.draws[d].transfer.size());
    for (std::size_t i = 0; i < a.draws[d].transfer.size(); ++i) {
      square += std::pow(double{a.draws[d].transfer[i]} - double{b.draws[d].transfer[i]}, 2);
      all += std::pow(double{b.draws[d].transfer[i]}, 2);
    }
  }
  return std::sqrt(square / all);
}

TEST_F(LeftOut, ShadowsOfABallAreNotMissed) {
  const Scene scene = testing::sceneOf({testing::icosphere({0, 0, 0}, 1.0f, 3)});
  const Baked planned = bakeWith(scene, "auto"), all = bakeWith(scene, "all");
  EXPECT_EQ(planned.report.rays + planned.report.refinement.rays, 0u);
  EXPECT_GT(all.report.rays, 0u);
  EXPECT_GT(all.report.refinement.rays, 0u);
  EXPECT_LT(difference(planned, all), 5e-4) << "codes alone may differ by 2e-4";
}

TEST_F(LeftOut, BouncesOfBlackSurfacesAreNotMissed) {
  Scene scene = testing::sceneOf(
      {testing::grid({0, 0, 0}, 3.0f, 8), testing::box({0.1f, 0.6f, 0.2f}, {0.8f, 0.6f, 0.7f}, 3)});
  scene.materials[0].base_color = glm::vec4(1e-4f, 1e-4f, 1e-4f, 1.0f);
  scene.materials[0].specular = 0.0f;
  const Baked planned = bakeWith(scene, "auto"), all = bakeWith(scene, "all");
  EXPECT_EQ(planned.report.hit_bytes, 0u) << "hits are kept for bounces alone";
  EXPECT_GT(all.report.hit_bytes, 0u);
  EXPECT_LT(difference(planned, all), 5e-4);
}

}  // namespace
}  // namespace lambent::baker
