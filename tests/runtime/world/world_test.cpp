// Tests that bundles are opened, closed and replaced while the world is shown: the rest shows the same
// picture as a world that never had the others, and nothing of them remains.
#include "runtime/world/world.hpp"

#include <fstream>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/frame/frame.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/frame/neighborhood_scene.hpp"
#include "tests/support/frame/world_stage.hpp"
#include "tests/support/gl_seam.hpp"

namespace lambent::frame {

using testing::WorldStage;
using testing::worst;
using WorldTest = testing::WorldTest;

TEST_F(WorldTest, AfterBundlesCloseAndOpenThePictureIsThatOfAFreshWorld) {
  WorldStage stage(lights);
  const std::uint32_t floor = stage.open(floorFile()), ball = stage.open(ballFile(0.0f)),
                      quad = stage.open(quadFile({1.0f, 0.2f, 0.1f, 1.0f})), mist = stage.open(mistFile());
  const spec::RgbaImage all = stage.picture();
  stage.world.close(ball);
  EXPECT_FALSE(stage.world.isOpen(ball));
  EXPECT_EQ(stage.world.status(ball).state, BundleStatus::State::Closed);
  expectSame(stage.picture(), fresh({floorFile(), quadFile({1.0f, 0.2f, 0.1f, 1.0f}), mistFile()}), stage);
  stage.world.close(mist);
  stage.world.close(quad);
  expectSame(stage.picture(), fresh({floorFile()}), stage);
  EXPECT_EQ(stage.open(ballFile(0.0f)), ball) << "the first free slot";
  EXPECT_EQ(stage.open(quadFile({1.0f, 0.2f, 0.1f, 1.0f})), quad);
  EXPECT_EQ(stage.open(mistFile()), mist);
  EXPECT_EQ(stage.world.status(floor).state, BundleStatus::State::Whole);
  expectSame(stage.picture(), all, stage);
}

TEST_F(WorldTest, AReplacementShowsInOneFrameAndNotBefore) {
  WorldStage stage(lights);
  stage.open(floorFile());
  const std::uint32_t ball = stage.open(ballFile(0.0f));
  stage.open(mistFile());
  const spec::RgbaImage before = stage.picture();
  WorldStage other(lights);
  other.open(floorFile());
  other.open(ballFile(0.0f));
  other.open(mistFile());
  other.world.close(ball);
  other.open(ballFile(0.4f));
  const spec::RgbaImage after = other.picture();
  ASSERT_GT(worst(before, after), 0.05) << "else nothing is tested";

  ASSERT_TRUE(stage.world.replace(ball, ballFile(0.4f)));
  EXPECT_EQ(stage.world.status(ball).replacement, ballFile(0.4f));
  int steps = 0;
  for (; stage.world.status(ball).path != ballFile(0.4f) && steps < 10'000; ++steps) {
    stage.render();
    const spec::RgbaImage image = stage.frame->readLinear();
    const double to_old = worst(image, before), to_new = worst(image, after);
    if (stage.world.status(ball).path != ballFile(0.4f)) {
      ASSERT_EQ(to_old, 0.0) << "frame " << steps << " to the new one " << to_new << ", replacement "
                             << stage.world.status(ball).replacement << ", errors "
                             << stage.world.errors().size();
    } else {
      EXPECT_LT(to_new, 0.02) << "lit and shadowed at once; light by captures follows";
    }
  }
  EXPECT_GT(steps, 1) << "one item a frame";
  EXPECT_TRUE(stage.world.status(ball).replacement.empty());
  expectSame(stage.picture(), after, stage);
}

TEST_F(WorldTest, ADamagedReplacementLeavesTheOldBundleAndIsReported) {
  WorldStage stage(lights);
  stage.open(floorFile());
  const std::uint32_t ball = stage.open(ballFile(0.0f));
  const spec::RgbaImage before = stage.picture();
  const std::uint64_t bytes = stage.world.residency().bytesResident();
  const std::filesystem::path damaged = file("damaged.lmb.glb");
  std::filesystem::copy_file(ballFile(0.4f), damaged);
  {
    std::fstream bytes_of(damaged, std::ios::in | std::ios::out | std::ios::binary);
    bytes_of.seekp(-64, std::ios::end);
    bytes_of.write("________________", 16);
  }
  ASSERT_TRUE(stage.world.replace(ball, damaged)) << "its description is whole";
  for (int i = 0; i < 1000 && stage.world.errors().empty(); ++i) stage.render();
  ASSERT_EQ(stage.world.errors().size(), 1u);
  EXPECT_EQ(stage.world.errors()[0].bundle, ball);
  EXPECT_NE(stage.world.errors()[0].error.subject.find("damaged.lmb.glb"), std::string::npos);
  EXPECT_EQ(stage.world.status(ball).state, BundleStatus::State::Whole);
  EXPECT_EQ(stage.world.status(ball).path, ballFile(0.0f));
  EXPECT_EQ(worst(stage.picture(), before), 0.0);
  EXPECT_EQ(stage.world.residency().bytesResident(), bytes);
  EXPECT_FALSE(stage.world.replace(ball, file("missing.lmb.glb")));
  EXPECT_EQ(stage.world.errors().size(), 1u);
  // The next valid bundle replaces it, and clears the error.
  ASSERT_TRUE(stage.world.replace(ball, damaged));
  ASSERT_TRUE(stage.world.replace(ball, ballFile(0.4f))) << "supersedes the other";
  stage.picture();
  EXPECT_TRUE(stage.world.errors().empty());
  EXPECT_EQ(stage.world.status(ball).path, ballFile(0.4f));
}

TEST_F(WorldTest, ABundleWithoutGpuMemoryIsReportedAndComesOnceThereIsSome) {
  WorldStage stage(lights);
  {
    const testing::FullGpu full;
    const Result<std::uint32_t> refused = stage.world.open(ballFile(0.0f));
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().problem.find("GPU: has no memory for "), std::string::npos)
        << refused.error().line();
  }
  EXPECT_TRUE(stage.world.errors().empty());
  const std::uint32_t ball = stage.open(ballFile(0.0f));
  {
    const testing::FullGpu full;  // from now on, so that its surfaces find none
    for (int i = 0; i < 1000 && !stage.world.loaded(); ++i) stage.render();
  }
  ASSERT_EQ(stage.world.errors().size(), 1u);
  EXPECT_EQ(stage.world.errors()[0].bundle, ball);
  EXPECT_NE(stage.world.errors()[0].error.problem.find("GPU: has no memory for "), std::string::npos)
      << stage.world.errors()[0].error.line();
  stage.world.close(ball);
  stage.open(ballFile(0.0f));
  expectSame(stage.picture(), fresh({ballFile(0.0f)}), stage);
}

TEST_F(WorldTest, APictureOfALostContextFails) {
  WorldStage stage(lights);
  stage.open(floorFile());
  stage.picture();
  const testing::LostContext lost;
  const spec::View view{.view_from_world = glm::mat4(1.0f), .clip_from_view = glm::mat4(1.0f), .eye_ws = {}};
  const Result<void> drawn = stage.frame->render(stage.world, stage.environment, view);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().subject, "GPU");
}

TEST_F(WorldTest, WhatWasChangedByHandSurvivesAndEntitiesStayTheSame) {
  WorldStage stage(lights);
  const std::uint32_t ball = stage.open(ballFile(0.0f), {.bundle_id = "ball"});
  stage.picture();
  const ecs::Entity node = stage.node("body"), root = stage.world.instance(ball).root;
  stage.world.registry().edit<scene::Transform>(node).translation.y = 3.0f;
  stage.world.registry().edit<scene::Transform>(root).translation.x = -0.5f;
  stage.world.registry().edit<scene::Name>(node).value = "moon";
  ASSERT_TRUE(stage.world.replace(ball, ballFile(0.4f)));
  stage.picture();
  ASSERT_EQ(stage.world.status(ball).path, ballFile(0.4f));
  EXPECT_EQ(stage.world.instance(ball).root, root);
  EXPECT_EQ(stage.node("moon"), node) << "renamed, but the same entity";
  const auto& place = stage.world.registry().get<scene::Transform>(node);
  EXPECT_EQ(place.translation, glm::vec3(0.0f, 3.0f, 0.0f));
  const ecs::Entity lid = stage.node("lid");
  EXPECT_EQ(stage.world.registry().get<scene::Transform>(lid).translation.x, 0.4f) << "nobody moved this one";
  EXPECT_EQ(stage.world.registry().get<scene::Transform>(root).translation.x, -0.5f);
  EXPECT_EQ(stage.world.registry().get<scene::StableId>(root), scene::instanceId("ball", 0));
}

}  // namespace lambent::frame
