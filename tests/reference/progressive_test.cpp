// Tests that the picture refined in the background equals that of `lambent reference`.
#include "reference/progressive.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "reference/lights.hpp"
#include "runtime/spec/image.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/media.hpp"

namespace lambent::baker::reference {
namespace {

using testing::rendered;

void waitABit() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

// Waits until the picture is finished or has failed.
ProgressiveStatus ended(const ProgressiveReference& reference) {
  for (;;) {
    auto status = reference.status();
    if (status.phase == ProgressivePhase::Finished || status.phase == ProgressivePhase::Failed) return status;
    waitABit();
  }
}

void untilTracing(const ProgressiveReference& reference) {
  while (reference.status().phase == ProgressivePhase::Preparing) waitABit();
}

class Progressive : public ::testing::Test {
 protected:
  std::shared_ptr<const Scene> shared() const { return std::make_shared<const Scene>(scene); }

  void expectTheReference(const ProgressiveReference& reference) const {
    const auto status = ended(reference);
    ASSERT_EQ(status.phase, ProgressivePhase::Finished) << (status.error ? status.error->line() : "");
    const auto snapshot = reference.snapshot();
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->generation, status.generation);
    EXPECT_EQ(snapshot->spp, request.options.spp);
    EXPECT_EQ(snapshot->coarseness, 1u);
    const Report expected = rendered(scene, request);
    EXPECT_EQ(snapshot->image.texels, expected.image.texels);
    EXPECT_EQ(snapshot->image.depths, expected.image.depths);
    EXPECT_EQ(snapshot->noise, expected.standard_error);
  }

  Scene scene = testing::ballOnAFloor();
  Request request = testing::ballInTheSun({.size = {61, 43}, .spp = 40, .seed = 3});
};

TEST_F(Progressive, EndsInTheBitsOfTheReferenceOfAsManySamples) {
  for (const std::uint32_t spp : {1u, 16u, 40u}) {
    request.options.spp = spp;
    expectTheReference(ProgressiveReference(shared(), request));
  }
}

TEST_F(Progressive, GivesTwoIndependentHalvesWhoseMeanIsThePicture) {
  const ProgressiveReference reference(shared(), request);
  ASSERT_EQ(ended(reference).phase, ProgressivePhase::Finished);
  const auto snapshot = reference.snapshot();
  const auto& [a, b] = snapshot->halves;
  ASSERT_EQ(a.texels.size(), snapshot->image.texels.size());
  EXPECT_EQ(a.depths, snapshot->image.depths);
  EXPECT_EQ(b.depths, snapshot->image.depths);
  double apart = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    const glm::dvec3 mean = 0.5 * (glm::dvec3(a.texels[i]) + glm::dvec3(b.texels[i]));
    ASSERT_LT(glm::length(mean - glm::dvec3(snapshot->image.texels[i])), 1e-5 * (1.0 + glm::length(mean)));
    if (snapshot->image.texels[i].w < spec::kLeastCoverage) continue;
    const glm::dvec3 difference(a.texels[i] - b.texels[i]);
    apart += glm::dot(difference, difference), energy += glm::dot(mean, mean);
  }
  // Half of their difference estimates the error of the mean.
  ASSERT_TRUE(snapshot->noise);
  EXPECT_NEAR(0.5 * std::sqrt(apart / energy), *snapshot->noise, 1e-4 * *snapshot->noise);
}

TEST_F(Progressive, GoesFromCoarseToFineAndNeverBack) {
  request.options.size = {320, 240};
  request.options.spp = 32;
  const Report fine = rendered(scene, request);
  ProgressiveReference reference(shared(), request);
  std::shared_ptr<const Snapshot> coarse;
  for (int attempt = 0; attempt < 50 && !coarse; ++attempt) {  // this thread may sleep through one
    const std::uint64_t generation = reference.restart(request);
    std::uint32_t coarseness = 8, spp = 0;
    while (reference.status().phase != ProgressivePhase::Finished) {
      const auto snapshot = reference.snapshot();
      std::this_thread::yield();
      if (!snapshot || snapshot->generation != generation) continue;
      ASSERT_LE(snapshot->coarseness, coarseness);
      ASSERT_GE(snapshot->spp, spp);
      ASSERT_EQ(snapshot->spp == 0, snapshot->coarseness > 1);
      coarseness = snapshot->coarseness, spp = snapshot->spp;
      if (coarseness > 1 && !coarse) coarse = snapshot;
    }
  }
  ASSERT_TRUE(coarse);
  ASSERT_EQ(coarse->image.texels.size(), fine.image.texels.size());
  // The coarse picture shows everything in its place: each quarter of the picture has the same light.
  for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
    double seen = 0.0, expected = 0.0;
    for (std::uint32_t y = quarter / 2 * 120; y < quarter / 2 * 120 + 120; ++y)
      for (std::uint32_t x = quarter % 2 * 160; x < quarter % 2 * 160 + 160; ++x) {
        seen += double{coarse->image.texels[y * 320 + x].g};
        expected += double{fine.image.texels[y * 320 + x].g};
      }
    EXPECT_NEAR(seen, expected, 0.1 * expected) << quarter;
  }
}

TEST_F(Progressive, BeginsAnewWithWhatChanged) {
  auto first = shared();
  const std::weak_ptr<const Scene> watch = first;
  ProgressiveReference reference(std::move(first), request);
  // The view and the light change while it works.
  request.camera.reset();
  request.view = spec::orbitView({70, 35, 1.5f, 50}, glm::vec3(-1), glm::vec3(1), 61.0f / 43.0f);
  request.lights.push_back(spec::SphereLight{.position_ws = {0, 2, 1}, .radius_m = 0.2f});
  EXPECT_EQ(reference.restart(request), 2u);
  expectTheReference(reference);
  EXPECT_FALSE(watch.expired());
  // A node is moved, and a material is changed.
  scene.nodes[1].parent_from_node = glm::translate(glm::mat4(1), glm::vec3(0.3f, 0.1f, 0));
  scene.materials[0].base_color = glm::vec4(0.2f, 0.6f, 0.1f, 1);
  reference.restart(shared(), request);
  expectTheReference(reference);
  EXPECT_TRUE(watch.expired()) << "keeps scenes that nobody needs";
}

TEST_F(Progressive, StopsInTheMidstOfAPictureWithoutEnd) {
  testing::place(scene, testing::even(40.0f, glm::vec3(1), 0.3f, {0, 0.8f, 0}));
  request.options.size = {4096, 2160};
  request.options.spp = kMaxSpp;
  const auto traced = shared();
  const std::weak_ptr<const Scene> watch = traced;
  {
    ProgressiveReference reference(traced, request);
    untilTracing(reference);
    EXPECT_EQ(reference.status().phase, ProgressivePhase::Tracing);
    EXPECT_EQ(reference.restart(request), 2u);
    untilTracing(reference);
    EXPECT_EQ(reference.status().phase, ProgressivePhase::Tracing) << "it would take days";
    EXPECT_EQ(reference.status().generation, 2u);
  }
  EXPECT_EQ(watch.use_count(), 1) << "nothing traces on after the end";
}

TEST_F(Progressive, SaysWhatIsWrongAndTakesTheNextRequest) {
  Request wrong = request;
  wrong.lights = {spec::EnvironmentMapLight{.file = "no/such/probe.hdr", .layout = {}}};
  ProgressiveReference reference(shared(), wrong);
  auto status = ended(reference);
  ASSERT_TRUE(status.error);
  EXPECT_NE(status.error->line().find("probe.hdr"), std::string::npos) << status.error->line();
  wrong = request;
  wrong.camera = spec::NamedCamera{"nowhere"};
  reference.restart(wrong);
  status = ended(reference);
  ASSERT_TRUE(status.error);
  EXPECT_NE(status.error->line().find("nowhere"), std::string::npos) << status.error->line();
  EXPECT_FALSE(reference.snapshot());
  reference.restart(request);
  expectTheReference(reference);
  EXPECT_FALSE(reference.status().error);
}

TEST(LightCache, ReadsAgainOnlyWhatChanged) {
  LightCache cache;
  std::vector<spec::Light> lights = {testing::uniform(0.3f), spec::SphereLight{}};
  Options options;
  const auto first = *cache.environment(lights, {}, options);
  std::get<spec::SphereLight>(lights[1]).radius_m = 2.0f;
  EXPECT_EQ(*cache.environment(lights, {1.0f, 7.0f}, options), first) << "a sphere in the scene is no sky";
  options.rotate_light_deg = 20.0f;
  const auto turned = *cache.environment(lights, {}, options);
  EXPECT_NE(turned, first);
  options.band_limit = BandLimit{.in = 3, .out = {}};
  EXPECT_NE(*cache.environment(lights, {}, options), turned);
  lights[0] = testing::uniform(2.0f);
  EXPECT_EQ((*cache.environment(lights, {}, options))->shown({0, 1, 0}, 0.01f), glm::vec3(2.0f));
}

TEST(Enlarged, LiesWhereThePictureDid) {
  // A linear gradient stays linear between the outer pixels' centres; 3 pixels cover the width of 10.
  const spec::RgbaImage slope{3,
                              2,
                              {glm::vec4(0.5f), glm::vec4(1.5f), glm::vec4(2.5f),  //
                               glm::vec4(0.5f), glm::vec4(1.5f), glm::vec4(2.5f)}};
  const auto large = enlarged(slope, {10, 7});
  ASSERT_EQ(large.texels.size(), 70u);
  for (std::uint32_t i = 0; i < 70; ++i)
    EXPECT_NEAR(large.texels[i].g, std::clamp((static_cast<float>(i % 10) + 0.5f) * 0.3f, 0.5f, 2.5f), 1e-5f);
}

}  // namespace
}  // namespace lambent::baker::reference
