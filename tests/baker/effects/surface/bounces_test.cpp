// Interreflection against closed forms (literature: a sphere's form factors are uniform; furnaces).
#include "baker/effects/surface/bounces.hpp"

#include <glm/ext/matrix_transform.hpp>

#include "baker/jobs/parallel.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::cavity;
using testing::flipped;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;
using testing::soup;
using testing::transformed;
using testing::Transport;
using testing::turned;
using testing::uniformRadiance;

// Returns the mean over the surface of every column of channel 0.
std::vector<double> surfaceMean(const Transport& t, const TransferField& field) {
  std::vector<double> sum(field.columns, 0.0);
  double area = 0.0;
  for (const glm::uvec3& triangle : t.geometry.triangles) {
    const double share = triangleArea(t.geometry, triangle) / 3.0;
    area += 3.0 * share;
    for (int corner = 0; corner < 3; ++corner) {
      const auto vector = field.at(t.samples.vertex_sample[triangle[corner]]);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += share * double{vector[i]};
    }
  }
  for (double& value : sum) value /= area;
  return sum;
}

TEST(Bounces, InACavityMatchTheClosedFormForEveryHarmonicAndBounce) {
  const glm::vec3 axis = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f));
  const testing::Cavity shape = cavity(axis, 60.0f);
  const double f = double{shape.opening};
  for (const float albedo : {0.5f, 0.8f}) {
    Scene scene = sceneOf({shape.mesh});
    scene.materials[0].base_color = glm::vec4(glm::vec3(albedo), 1.0f);
    const Transport t(scene);
    std::vector<float> towards_opening(25);
    sh::unoccludedTransfer(5, axis, std::span<float>(towards_opening));  // (A_l/pi) y_lm(axis)
    std::vector<double> sum(25, 0.0);
    for (int bounces = 0; bounces <= 3; ++bounces) {
      const auto baked = t.bake(5, 1024, bounces);
      const auto mean = surfaceMean(t, bounces == 0 ? baked.direct.field : baked.bounced.field);
      // <E0>/pi = f (A_l/pi) y_lm; each bounce spreads the mean evenly: times albedo (1 - f).
      if (bounces > 0)
        for (std::size_t i = 0; i < 25; ++i)
          sum[i] += f * double{towards_opening[i]} * std::pow(double{albedo} * (1.0 - f), bounces);
      for (std::size_t i = 0; i < 25; ++i) {
        const double expected = bounces == 0 ? f * double{towards_opening[i]} : sum[i];
        // The tolerance is half a percent of the uniform part, plus the effect of the mesh's jagged rim on
        // high bands.
        EXPECT_NEAR(mean[i], expected, 0.005 * f * 0.2821 + 0.004 * f) << "bounces " << bounces << " i " << i;
      }
      if (bounces == 0) continue;
      // Indirect light is the same everywhere on the wall: 2 % per point for the facets.
      for (std::size_t s = 0; s < t.samples.size(); ++s) {
        if (t.samples.originsOf(s).empty()) continue;
        EXPECT_NEAR(baked.bounced.field.at(s)[0], sum[0], 0.02 * sum[0]);
      }
    }
  }
}

TEST(Bounces, InAWhiteFurnaceAddUpToOne) {
  // A ball is in an open cup, with albedo 1 and uniform light. No light is lost, so every point sees radiance
  // 1.
  const Transport t(sceneOf({testing::cup({2, 1, 2}, 6), icosphere({0.3f, -0.1f, 0.1f}, 0.3f, 3)}));
  const auto baked = t.bake(3, 256, kMostBounces);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    if (t.samples.originsOf(s).empty()) continue;
    const float sum = uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s));
    // The result is exact except for the passes with less than 1 % of the light, whose rays (every fourth)
    // err by a few percent.
    EXPECT_NEAR(sum, 1.0f, 1e-3f);
  }
}

TEST(Bounces, NeverHaveMoreEnergyThanAlbedoTimesTheBounceBefore) {
  Scene scene = sceneOf({soup(5, 0.5f, 0.0f)});
  scene.materials[0].double_sided = true;
  constexpr float kAlbedo = 0.7f;
  scene.materials[0].base_color = glm::vec4(glm::vec3(kAlbedo), 1.0f);
  const Transport t(scene);
  float before = 1.0f;
  std::vector<float> sum(t.samples.size(), 0.0f);
  for (int bounces = 1; bounces <= 4; ++bounces) {
    const auto baked = t.bake(2, 256, bounces);
    float largest = 0.0f;
    for (std::size_t s = 0; s < t.samples.size(); ++s) {
      const float all = uniformRadiance(baked.bounced.field.at(s));
      largest = testing::larger(largest, all - sum[s]);
      EXPECT_GE(all - sum[s], -1e-6f);
      sum[s] = all;
    }
    EXPECT_LE(largest, kAlbedo * before * 1.0001f);
    before = largest;
  }
}

TEST(Bounces, AreNoneOnAConvexBody) {
  const Transport t(sceneOf({icosphere({0, 0, 0}, 1.0f, 3)}));
  for (const float value : t.bake(5, 256, 2).bounced.field.vectors) EXPECT_EQ(value, 0.0f);
}

TEST(Bounces, CarryTheColourOfTheWallAndOfItsTexture) {
  // A floor is beside a red wall; then the same red comes from a texture.
  Scene scene =
      sceneOf({grid({0, 0, 0}, 1.0f, 4), transformed(turned(grid({0, 0, 0}, 1.0f, 4), -90.0f, {0, 0, 1}),
                                                     glm::translate(glm::mat4(1.0f), {-0.5f, 0.5f, 0}))});
  testing::ownMaterial(scene, 1).base_color = {1.0f, 0.0f, 0.0f, 1.0f};
  const Transport painted(scene);
  EXPECT_FALSE(painted.colors.grey());
  const auto a = painted.bake(3, 256, 1);
  const std::size_t s = painted.sampleAt({-0.25f, 0.0f, 0.0f});
  EXPECT_GT(a.bounced.field.at(s)[0], 0.01f);
  EXPECT_EQ(a.bounced.field.at(s)[9], 0.0f);   // green
  EXPECT_EQ(a.bounced.field.at(s)[18], 0.0f);  // blue

  const spec::Rgba8Image red{
      .width = 2, .height = 2, .texels = {255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255}};
  const auto png = spec::encodePng(red);
  const auto bytes = std::as_bytes(std::span(png));
  scene.images.push_back({"red", "image/png", {bytes.begin(), bytes.end()}});
  scene.textures.push_back({0, {}});
  scene.materials[1].base_color = glm::vec4(1.0f);
  scene.materials[1].base_color_texture.texture = 0;
  const Transport textured(scene);
  EXPECT_FALSE(textured.colors.grey());
  EXPECT_EQ(textured.bake(3, 256, 1).bounced.field.vectors, a.bounced.field.vectors);
}

TEST(Bounces, AreTheSameForAnyMemoryAndNumberOfThreads) {
  const Transport t(sceneOf({grid({0, 0, 0}, 2.0f, 40), icosphere({0, 0.6f, 0}, 0.5f, 3)}));
  const auto kept = t.bake(4, 256, 2);
  EXPECT_GT(kept.direct.of(SurfacePart::Matte).hits.bytes(), 0u);
  const auto again = t.bake(4, 256, 2, 1e-3, /*hit_memory=*/0);
  EXPECT_EQ(again.direct.of(SurfacePart::Matte).hits.bytes(), 0u);
  EXPECT_EQ(kept.bounced.field.vectors, again.bounced.field.vectors);
  withThreads(1, [&] { EXPECT_EQ(t.bake(4, 256, 2).bounced.field.vectors, kept.bounced.field.vectors); });
}

TEST(Bounces, LoseNoLightByHitsThatAreNotKept) {
  Scene lit = sceneOf({flipped(icosphere({0, 0, 0}, 1.0f, 3))});  // a white room of radius 1
  testing::addPointLight(lit, {0.4f, 0.1f, 0.0f});
  const auto bouncesWith = [&](std::uint32_t hits_of_every) {
    const Transport room(lit);
    const DirectPass pass(room.diffuse(), {.order = 3,
                                           .rays = 512,
                                           .keep_hits = true,
                                           .hits_of_every = hits_of_every,
                                           .hit_memory = std::size_t{1} << 30});
    Progress progress;
    auto direct = bakeDirect(pass, {progress});
    const auto bounced = bakeBounces({pass, *direct}, {3, 1e-3}, {progress});
    return std::pair(direct->of(SurfacePart::Matte).hits.bytes(), surfaceMean(room, bounced->field).back());
  };
  const auto [all_bytes, all] = bouncesWith(1);
  const auto [some_bytes, some] = bouncesWith(4);
  EXPECT_GT(all, 0.0);
  EXPECT_NEAR(some, all, 5e-3 * all);
  EXPECT_LT(some_bytes, 0.26 * static_cast<double>(all_bytes));
}

TEST(Bounces, EndWhenWhatIsLeftOutIsUnderTheBound) {
  Scene scene = sceneOf({cavity({0, 1, 0}, 60.0f).mesh});
  scene.materials[0].base_color = glm::vec4(glm::vec3(0.5f), 1.0f);
  const Transport t(scene);
  const auto until = t.bake(3, 256, -1, 1e-3), all = t.bake(3, 256, 30);
  EXPECT_LT(until.bounced.energy.size(), 12u);
  EXPECT_LT(until.bounced.left_out, 1e-3);
  for (std::size_t s = 0; s < t.samples.size(); ++s) {
    const float whole = all.direct.field.at(s)[0] + all.bounced.field.at(s)[0];
    EXPECT_NEAR(until.bounced.field.at(s)[0], all.bounced.field.at(s)[0], 2e-3f * whole);
  }
}

}  // namespace
}  // namespace lambent::baker
