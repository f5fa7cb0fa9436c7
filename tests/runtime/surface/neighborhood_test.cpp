// Tests neighborhoods in whole frames: black spheres over floors, with light known in closed form.

#include "tests/support/differences.hpp"
#include "tests/support/frame/neighborhood_checks.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::frame {

TEST_F(NeighborhoodFrame, ABlackSphereOverAFloorUnderConstantLightIsTheClosedForm) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kFine, kFineHalf)};
  NeighborhoodStage stage(scene, {kWhite});
  const spec::RgbaImage image = stage.picture();
  // By literature 7.2, E/pi = 1 - (R/d)^2 cos t of the unoccluded floor's light. Straight below, bands 0..2
  // of the light, which are all that a diffuse receiver uses, miss 0.86 % of it.
  const auto closedForm = [](const glm::vec3& place) {
    const float squared = 1.5f * 1.5f + glm::dot(place, place);
    return glm::vec3(1.0f - 1.5f / (squared * std::sqrt(squared)));
  };
  EXPECT_LT(worst(stage, image, 2.7f, closedForm, glm::vec3(1.0f)), 0.01);
  EXPECT_LT(worst(stage, image, 2.7f, ideal(stage.environment, {{0.0f, 1.5f, 0.0f}})), 0.01);
  EXPECT_EQ(stage.frame->counts()["neighborhood_grids"], 1u);
  EXPECT_EQ(stage.frame->counts()["neighborhood_receivers"], 1u);
}

TEST_F(NeighborhoodFrame, TurnedBodiesAndTurnedReceiversGetTheSameLight) {
  std::optional<spec::RgbaImage> first;
  for (const bool turn_body : {false, true})
    for (const bool turn_floor : {false, true}) {
      NeighborhoodScene scene;
      BuiltReceiver floor = floorOf(8.0f);
      if (turn_floor) {
        floor.turn = kTurn;
        floor.place = {1.0f, 2.0f, 3.0f};
        glm::mat4 placed = glm::mat4_cast(kTurn);
        placed[3] = glm::vec4(floor.place, 1.0f);
        floor.group_from_mesh = glm::inverse(placed);
      }
      scene.receivers = {floor};
      scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kWide, kWideHalf)};
      if (turn_body) scene.bodies[0].turn = glm::inverse(kTurn);
      NeighborhoodStage stage(scene, {kSun, kWhite});
      stage.half = 2.5f;
      const spec::RgbaImage image = stage.picture();
      EXPECT_LT(worst(stage, image, 2.5f, ideal(stage.environment, {{0.0f, 1.5f, 0.0f}}),
                      openLight(stage.environment)),
                0.025)
          << turn_body << turn_floor;
      if (!first) first = image;
      EXPECT_LT(worstDifference(*first, image), 0.06) << "under a light of up to 4";
    }
}

TEST_F(NeighborhoodFrame, BodiesThatMoveAndTurnTakeTheirShadowsAlong) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kWide, kWideHalf)};
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.half = 2.0f;
  stage.picture();
  stage.edit("body").translation = {0.7f, 1.8f, -0.4f};
  stage.edit("body").rotation = kTurn;
  const spec::RgbaImage image = stage.picture();
  EXPECT_LT(worst(stage, image, 2.0f, ideal(stage.environment, {{0.7f, 1.8f, -0.4f}}),
                  openLight(stage.environment)),
            0.025);
}

TEST_F(NeighborhoodFrame, ScaledBodiesHaveScaledNeighborhoods) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, kFine, kFineHalf)};
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.half = 1.2f;
  stage.picture();
  stage.edit("body").scale = glm::vec3(0.5f);
  const spec::RgbaImage image = stage.picture();
  EXPECT_LT(worst(stage, image, 1.2f, ideal(stage.environment, {{0.0f, 1.5f, 0.0f}}, 0.5f),
                  openLight(stage.environment)),
            0.015);
}

TEST_F(NeighborhoodFrame, OverlappingNeighborhoodsAddAndNeverTakeMoreThanThereIs) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  const glm::vec3 left(-1.1f, 1.5f, 0.0f), right(1.1f, 1.8f, 0.3f);
  scene.bodies = {sphereAt(left, 1.0f, kWide, kWideHalf),
                  sphereAt(right, 1.0f, glm::uvec3(45, 29, 47), glm::vec3(4.5f))};
  scene.bodies[1].name = "other";
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.half = 2.5f;
  EXPECT_LT(worst(stage, stage.picture(), 2.5f, ideal(stage.environment, {left, right}),
                  openLight(stage.environment)),
            0.02);
  EXPECT_EQ(stage.frame->counts()["neighborhood_arrivals"], 2u);
  // Two spheres at one place would take more light than there is.
  stage.edit("body").translation = stage.edit("other").translation = {0.0f, 1.06f, 0.0f};
  float least = 1.0f;
  for (const glm::vec4& texel : stage.picture().texels)
    for (int c = 0; c < 3; ++c) least = testing::smaller(least, texel[c]);
  EXPECT_EQ(least, 0.0f);
  EXPECT_EQ(stage.frame->negativePixels(), 0u);
}

TEST_F(NeighborhoodFrame, AReceiverThatPassesTheBorderHasNoStep) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  // The grid is so small that the change is not nearly zero at its faces.
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f}, 1.0f, glm::uvec3(13), glm::vec3(2.2f))};
  NeighborhoodStage stage(scene, {kSun, kWhite});
  const spec::RgbaImage image = stage.picture();
  const glm::vec3 open = irradianceOverPi(
      {stage.environment.light().c.begin(), stage.environment.light().c.begin() + 25}, glm::vec3(0, 1, 0));
  constexpr std::uint32_t n = NeighborhoodStage::kSide;
  double step = 0.0, depth = 0.0;
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const glm::vec4 here = image.texels[y * n + x], next = image.texels[y * n + x + 1];
      step = testing::larger(step, std::abs(here.r - next.r));
      depth = testing::larger(depth, open.r - here.r);
      const glm::vec3 place = stage.placeOf(x, y);
      if (std::max(std::abs(place.x), std::abs(place.z)) <= 2.2f) continue;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(here[c], open[c], 2e-4f) << place.x << " " << place.z;
    }
  // Smoothstep over a cell of 2.9 pixels is at most 0.52 of all of it from one pixel to the next.
  EXPECT_GT(depth, 1.0);
  EXPECT_LT(step, 0.35 * depth);
}

TEST_F(NeighborhoodFrame, AConstantLightCostsNothingButTheLookUp) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.picture();
  stage.render();
  ASSERT_TRUE(stage.counts("neighborhood"));
  EXPECT_EQ(stage.counts("neighborhood")->dispatches, 0u);
  EXPECT_EQ(stage.counts("glossy")->dispatches, 0u);
  EXPECT_EQ(stage.counts("neighborhood")->uploaded_bytes, 0u);
  // A body that moves without turning only moves its texture.
  stage.edit("body").translation.x += 0.5f;
  stage.render();
  EXPECT_EQ(stage.counts("neighborhood")->dispatches, 0u);
  EXPECT_EQ(stage.counts("glossy")->dispatches, 0u);
  EXPECT_GT(stage.counts("neighborhood")->uploaded_bytes, 0u) << "where it is now";
  stage.edit("body").rotation = kTurn;
  stage.render();
  EXPECT_EQ(stage.counts("neighborhood")->dispatches, 1u) << "the light turned, as the body has it";
  EXPECT_EQ(stage.frame->counts()["neighborhood_grids_written"], 1u);
  stage.environment.setTurn(20.0f);
  stage.render();
  EXPECT_EQ(stage.counts("neighborhood")->dispatches, 1u);
}

TEST_F(NeighborhoodFrame, SwitchedOffNothingIsHeldOrRun) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
  NeighborhoodStage stage(scene, {kWhite}, /*neighborhoods=*/false);
  const spec::RgbaImage image = stage.picture();
  EXPECT_FALSE(stage.counts("neighborhood"));
  EXPECT_EQ(stage.counts("glossy")->dispatches, 0u);
  EXPECT_LT(worst(stage, image, 4.0f, [](const glm::vec3&) { return glm::vec3(1.0f); }), 2e-4);
}

TEST_F(NeighborhoodFrame, UnshadowedChangesNothing) {
  NeighborhoodScene scene;
  scene.receivers = {floorOf(8.0f)};
  scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
  NeighborhoodStage stage(scene, {kWhite});
  FrameOptions options = stage.frame->options();
  options.settings.transfer = evaluate::TransferMode::Unshadowed;
  stage.frame.emplace(*Frame::create(options, stage.environment));
  EXPECT_LT(worst(stage, stage.picture(), 4.0f, [](const glm::vec3&) { return glm::vec3(1.0f); }), 2e-4);
}

TEST_F(NeighborhoodFrame, LightOfAnyStrengthFitsTheTexture) {
  for (const float strength : {1e-7f, 1e7f}) {
    NeighborhoodScene scene;
    scene.receivers = {floorOf(8.0f)};
    scene.bodies = {sphereAt({0.0f, 1.5f, 0.0f})};
    NeighborhoodStage stage(scene, {spec::ConstantLight{.radiance = glm::vec3(strength)}});
    spec::RgbaImage image = stage.picture();
    for (glm::vec4& texel : image.texels) texel /= strength;
    EXPECT_LT(worst(stage, image, 2.7f,
                    [&](const glm::vec3& place) {
                      return ideal(stage.environment, {{0.0f, 1.5f, 0.0f}})(place) / strength;
                    }),
              0.03)
        << strength;
  }
}

TEST_F(NeighborhoodFrame, NormalMappedReceiversWithoutAMapAreLikePlainOnes) {
  NeighborhoodScene plain, mapped;
  plain.receivers = {floorOf(8.0f)};
  plain.bodies = {sphereAt({0.3f, 1.5f, 0.2f})};
  mapped = plain;
  mapped.receivers[0].outputs = 9;
  // Its mesh stands crooked in its group.
  mapped.receivers[0].turn = kTurn;
  glm::mat4 placed = glm::mat4_cast(kTurn);
  mapped.receivers[0].group_from_mesh = glm::inverse(placed);
  std::vector<spec::RgbaImage> images;
  for (const NeighborhoodScene* scene : {&plain, &mapped}) {
    NeighborhoodStage stage(*scene, {kWhite});
    images.push_back(stage.picture());
  }
  EXPECT_LT(worstDifference(images[0], images[1]), 1e-3);
}

TEST_F(NeighborhoodFrame, GlossyReceiversReflectTheChangedLight) {
  constexpr int kOrder = 4;
  NeighborhoodScene scene;
  scene.order = kOrder;
  scene.table = baker::integrateTable(*baker::makeGgx(/*anisotropic=*/false), kOrder,
                                      {.angles = 12, .azimuths = 1, .roughnesses = 6, .strengths = 1});
  BuiltReceiver floor = floorOf(8.0f);
  floor.outputs = kOrder * kOrder;
  floor.material.base_color = glm::vec4(0.8f, 0.5f, 0.2f, 1.0f);
  floor.material.metallic = 0.5f;
  floor.material.roughness = 0.6f;
  floor.turn = kTurn;
  floor.group_from_mesh = glm::inverse(glm::mat4_cast(kTurn));
  scene.receivers = {floor};
  const glm::vec3 middle(0.4f, 1.5f, -0.3f);
  scene.bodies = {sphereAt(middle, 1.0f, kFine, kFineHalf)};
  scene.bodies[0].outputs = kOrder * kOrder;
  scene.bodies[0].turn = glm::angleAxis(std::numbers::pi_v<float> / 2.0f, glm::vec3(0, 1, 0));
  NeighborhoodStage stage(scene, {kSun, kWhite});
  stage.half = 2.0f;
  const spec::RgbaImage image = stage.picture();
  ASSERT_EQ(stage.frame->counts()["neighborhood_receivers"], 1u);
  const glossy::glsl::Table table(*scene.table);
  glossy::glsl::Isotropic kernel;
  const sh::LightVector light = stage.environment.light().truncated(kOrder);
  const glm::vec3 up(0, 1, 0);
  const auto expected = [&](const glm::vec3& place) {
    const auto change = changeOf(light, kOrder, kOrder, blackSphere(1.0f)(2 * kOrder - 1, place - middle));
    std::vector<glm::vec4> sum;
    for (std::size_t i = 0; i < change.size(); ++i) sum.emplace_back(light.c[i] + change[i], 0.0f);
    const auto reflected = table.reflect({up, {}, up, 0.6f, 0.0f}, sum);
    const glm::vec3 base(floor.material.base_color);
    const auto fresnel = kernel.fresnelOf(base, 0.5f, glm::vec3(0.04f), 1.0f);
    return fresnel.f0 * glm::vec3(reflected.f0_light) + fresnel.f90 * glm::vec3(reflected.f90_light) +
           kernel.diffuseAlbedo(base, 0.5f, fresnel, glm::vec2(reflected.albedo)) *
               glm::vec3(reflected.diffuse);
  };
  EXPECT_LT(worst(stage, image, 2.0f, expected, expected(glm::vec3(100.0f, 0.0f, 0.0f))), 0.01);
}

TEST_F(NeighborhoodFrame, FineReceiversWithAllBandsReceiveThroughTheirOwnTransfer) {
  constexpr std::uint32_t kOrder = 4;
  const glm::vec3 full(0.5f, 0.8f, 0.2f);
  std::vector<spec::RgbaImage> images;
  for (const bool turned : {false, true}) {
    NeighborhoodScene scene;
    scene.order = kOrder;
    BuiltReceiver floor = floorOf(4.0f, 64);
    floor.full = full;
    if (turned) {
      floor.turn = kTurn;
      floor.group_from_mesh = glm::inverse(glm::mat4_cast(kTurn));
    }
    // A glossy receiver is next to it, whose draws bind other storage.
    scene.table = baker::integrateTable(*baker::makeGgx(/*anisotropic=*/false), kOrder,
                                        {.angles = 4, .azimuths = 1, .roughnesses = 2, .strengths = 1});
    BuiltReceiver glossy = floorOf(0.2f);
    glossy.name = "glossy";
    glossy.outputs = kOrder * kOrder;
    glossy.material.metallic = 1.0f;
    glossy.place = {3.5f, 0.5f, 3.5f};
    scene.receivers = {glossy, floor};
    const glm::vec3 middle(0.3f, 1.5f, -0.2f);
    scene.bodies = {sphereAt(middle, 1.0f, kFine, kFineHalf)};
    scene.bodies[0].outputs = kOrder * kOrder;
    if (turned) scene.bodies[0].turn = glm::angleAxis(std::numbers::pi_v<float> / 2.0f, glm::vec3(0, 1, 0));
    NeighborhoodStage stage(scene, {kSun, kWhite});
    stage.half = 2.0f;
    images.push_back(stage.picture());
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers"], 1u);
    EXPECT_EQ(stage.frame->counts()["neighborhood_receivers"], 0u)
        << "not per pixel too; the glossy one is beyond";
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers_shaded"], 0u) << "at rest";
    // A receiver with four bands gets the same as one with three, because A_3 is 0.
    const sh::LightVector light = stage.environment.light().truncated(kOrder);
    const auto expected = [&](const glm::vec3& place) {
      auto sum = changeOf(light, kOrder, kOrder, blackSphere(1.0f)(2 * kOrder - 1, place - middle));
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += light.c[i];
      return full * irradianceOverPi(sum, glm::vec3(0, 1, 0));
    };
    EXPECT_LT(worst(stage, images.back(), 2.0f, expected, expected(glm::vec3(100.0f, 0.0f, 0.0f))), 0.015);
    stage.edit("body").translation.x += 0.5f;
    stage.render();
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers_shaded"], 1u);
    stage.render();
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers_shaded"], 0u);
    stage.environment.setTurn(30.0f);
    stage.render();
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers_shaded"], 1u);
  }
  EXPECT_LT(worstDifference(images[0], images[1]), 0.05) << "under a light of up to 4";
}

TEST_F(NeighborhoodFrame, CoarseReceiversOrFewBandsStayPerPixel) {
  for (const bool coarse : {true, false}) {
    NeighborhoodScene scene;
    scene.order = 4;
    scene.receivers = {floorOf(4.0f, coarse ? 4 : 64)};
    scene.bodies = {sphereAt({0.3f, 1.5f, -0.2f})};
    scene.bodies[0].outputs = coarse ? 16 : 9;
    NeighborhoodStage stage(scene, {kSun, kWhite});
    stage.picture();
    EXPECT_EQ(stage.frame->counts()["neighborhood_vertex_receivers"], 0u);
    EXPECT_EQ(stage.frame->counts()["neighborhood_receivers"], 1u);
  }
}

}  // namespace lambent::frame
