// Tests the depths of linear pictures: metres along the view axis, of opaque surfaces, infinite where there
// is none.
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::quadMesh;
using testing::ViewStage;

constexpr float kNone = std::numeric_limits<float>::infinity();
using testing::kWhite;

// Makes a square of 2 m times `scale` that faces the camera, at this z.
testing::BuiltMesh square(float z, float scale = 1.0f, gltf::AlphaMode alpha_mode = gltf::AlphaMode::Opaque,
                          float alpha = 1.0f) {
  gltf::Material material;
  material.alpha_mode = alpha_mode;
  material.base_color.a = alpha;
  return {quadMesh(), material,
          glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, z)), glm::vec3(scale))};
}

// Returns depths seen from 10 m away on +Z.
std::vector<float> depthsOf(ViewStage& stage, const glm::mat4& clip_from_view) {
  const glm::vec3 eye(0, 0, 10);
  const spec::View view{.view_from_world = glm::lookAt(eye, glm::vec3(0.0f), glm::vec3(0, 1, 0)),
                        .clip_from_view = clip_from_view,
                        .eye_ws = eye};
  stage.world.updateTransforms();
  const Result<void> done = stage.frame->render(stage.world, stage.environment, view);
  EXPECT_TRUE(done) << done.error().line();
  return stage.frame->readLinear().depths;
}

const glm::mat4 kWide = glm::perspective(glm::radians(90.0f), 1.0f, 1.0f, 30.0f),
                kNarrow = glm::perspective(glm::radians(5.0f), 1.0f, 1.0f, 30.0f);

}  // namespace

using FrameDepths = testing::GpuTest;

TEST_F(FrameDepths, AreMetresAlongTheAxisInPerspectivesAndParallelProjections) {
  // A wall is behind all pixels, and a square is in front of its middle; rays in the corners are 1.7 times as
  // long.
  ViewStage stage(BundleBuilder().add(square(-2.0f, 13.0f)).add(square(4.0f, 3.0f)), {kWhite},
                  testing::linearOptions());
  for (const glm::mat4& clip_from_view : {kWide, glm::ortho(-6.0f, 6.0f, -6.0f, 6.0f, 1.0f, 30.0f)}) {
    const std::vector<float> depths = depthsOf(stage, clip_from_view);
    ASSERT_EQ(depths.size(), 64u * 64u);
    for (const std::size_t y : {1u, 20u, 31u, 32u, 43u, 62u})
      for (const std::size_t x : {1u, 20u, 31u, 32u, 43u, 62u}) {
        const bool before = x >= 20 && x <= 43 && y >= 20 && y <= 43;
        // Half floats would not be this exact: depths have 24 bits over 30 m.
        EXPECT_NEAR(depths[y * 64 + x], before ? 6.0f : 12.0f, 2e-5f) << x << ", " << y;
      }
  }
}

TEST_F(FrameDepths, HaveRowZeroAtTheTopAndAreInfiniteWhereNothingStands) {
  BundleBuilder builder;
  testing::BuiltMesh high = square(0.0f);
  high.world_from_mesh = glm::translate(glm::mat4(1.0f), glm::vec3(0, 1, 0));
  builder.add(high);
  ViewStage stage(builder, {kWhite}, testing::linearOptions());
  const std::vector<float> depths = depthsOf(stage, glm::ortho(-3.0f, 3.0f, -3.0f, 3.0f, 1.0f, 30.0f));
  EXPECT_NEAR(depths[22 * 64 + 32], 10.0f, 2e-5f);
  EXPECT_EQ(depths[42 * 64 + 32], kNone);
  EXPECT_EQ(depths[0], kNone);
}

TEST_F(FrameDepths, AreOfWhatStandsBehindBlendedSurfacesAndInTheHolesOfOthers) {
  const auto middle = [](const BundleBuilder& builder) {
    ViewStage stage(builder, {kWhite}, testing::linearOptions());
    return depthsOf(stage, kNarrow)[32 * 64 + 32];
  };
  using enum gltf::AlphaMode;
  for (const float alpha : {0.5f, 1.0f}) {
    EXPECT_NEAR(middle(BundleBuilder().add(square(0.0f)).add(square(2.0f, 1.0f, Blend, alpha))), 10.0f,
                2e-5f);
    EXPECT_EQ(middle(BundleBuilder().add(square(2.0f, 1.0f, Blend, alpha))), kNone);
  }
  EXPECT_NEAR(middle(BundleBuilder().add(square(0.0f)).add(square(2.0f, 1.0f, Mask, 0.4f))), 10.0f, 2e-5f);
  EXPECT_NEAR(middle(BundleBuilder().add(square(0.0f)).add(square(2.0f, 1.0f, Mask, 0.6f))), 8.0f, 2e-5f);
}

TEST_F(FrameDepths, AreTheSameInOtherViews) {
  ViewStage stage(BundleBuilder().add(square(-2.0f, 13.0f)).add(square(4.0f, 3.0f)), {kWhite},
                  testing::linearOptions());
  const std::vector<float> final = depthsOf(stage, kWide);
  for (const SurfaceView view : {SurfaceView::Normals, SurfaceView::TransferDc, SurfaceView::Wireframe}) {
    stage.frame->setView({.view = view});
    const std::vector<float> depths = depthsOf(stage, kWide);
    ASSERT_EQ(depths.size(), final.size());
    for (std::size_t i = 0; i < depths.size(); ++i) ASSERT_NEAR(depths[i], final[i], 2e-5f) << i;
  }
}

}  // namespace lambent::frame
