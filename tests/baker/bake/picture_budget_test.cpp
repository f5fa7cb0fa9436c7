// Tests how a bound on the error of pictures is divided among rays, refinement and codes.
#include "baker/bake/picture_budget.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace lambent::baker {
namespace {

// What a scene shows: noise falls with the root of rays, and interpolation goes with refinement's bound.
struct Model {
  double noise_of_256_rays, interpolation_per_bound;

  bundle::PictureError shownWith(const PictureSettings& settings) const {
    const double samples = noise_of_256_rays * std::sqrt(256.0 / settings.rays),
                 interpolation = interpolation_per_bound * double{settings.refine_bound};
    return {.all = static_cast<float>(std::hypot(samples, interpolation)),
            .samples = static_cast<float>(samples),
            .codes = 0.0f,
            .interpolation = static_cast<float>(interpolation),
            .points = 1000};
  }
};

TEST(PictureBudget, FindsSettingsForScenesThatDifferALot) {
  for (const Model& scene : {Model{0.004, 0.2}, Model{0.013, 0.5}, Model{0.038, 1.5}})
    for (const float bound : {0.04f, 0.02f, 0.01f}) {
      PictureTry tried{.made_with = {firstRays(bound), firstRefineBound(bound)}, .shown = {}};
      int tries = 1;
      for (; tries < kMostTries; ++tries) {
        tried.shown = scene.shownWith(tried.made_with);
        tried.refined_to = double{tried.made_with.refine_bound};
        if (leavesEnough(tried.shown, bound)) break;
        const auto next = nextTry(tried, bound);
        ASSERT_TRUE(next) << "noise " << scene.noise_of_256_rays << " bound " << bound;
        tried.made_with = *next;
      }
      const bundle::PictureError shown = scene.shownWith(tried.made_with);
      EXPECT_TRUE(leavesEnough(shown, bound)) << "noise " << scene.noise_of_256_rays << " bound " << bound;
      EXPECT_LE(tries, 2) << "a scene of this kind is understood at once";
      EXPECT_LE(std::hypot(shown.all, codesBound(shown, bound)), bound);
    }
}

TEST(PictureBudget, KeepsWhatIsGiven) {
  const PictureTry tried{.made_with = {256, 0.02f},
                         .refined_to = 0.02,
                         .shown = {.all = 0.05f, .samples = 0.04f, .interpolation = 0.03f, .points = 1000},
                         .keeps_rays = true,
                         .keeps_refinement = true};
  EXPECT_FALSE(nextTry(tried, 0.01f));
  PictureTry free = tried;
  free.keeps_rays = false;
  EXPECT_GT(nextTry(free, 0.01f)->rays, 256u);
  EXPECT_EQ(nextTry(free, 0.01f)->refine_bound, 0.02f);
}

TEST(PictureBudget, GivesCodesAnotherBoundWhereEyesSeeMoreOfThem) {
  const bundle::PictureError twice{.all = 0.0128f, .samples = 0.008f, .codes = 0.01f, .points = 1000};
  const auto less = nextCodesBound(0.005f, twice, 0.01f);
  ASSERT_TRUE(less);
  EXPECT_NEAR(*less, 0.0026f, 0.0002f);
  const bundle::PictureError fine{.all = 0.0094f, .samples = 0.008f, .codes = 0.005f, .points = 1000};
  EXPECT_FALSE(nextCodesBound(0.005f, fine, 0.01f));
}

}  // namespace
}  // namespace lambent::baker
