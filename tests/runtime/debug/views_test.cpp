// Tests views of surfaces: their words, their numbers in pictures, and that a picture without them stays the
// same.
#include "runtime/surface/views.hpp"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/debug/data_view.hpp"
#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::linearOptions;
using testing::quadMesh;
using testing::sphereMesh;
using testing::ViewStage;

using testing::kWhite;

BundleBuilder openSphere() {
  gltf::Material material;
  material.base_color = {0.8f, 0.5f, 0.2f, 1.0f};
  return BundleBuilder().add({sphereMesh(24, 48), material});
}

}  // namespace

TEST(ViewWords, EveryViewIsFoundByItsNameAndByNoOther) {
  for (const SurfaceViewRow& row : kSurfaceViews) {
    const auto choice = parseView(row.name);
    ASSERT_TRUE(choice) << row.name;
    EXPECT_EQ(choice->view, row.view);
    EXPECT_EQ(*parseView(wordOf(*choice)), *choice);
  }
  for (const char* wrong : {"", "transfer", "final:1", "Normals"}) {
    const auto choice = parseView(wrong);
    ASSERT_FALSE(choice) << wrong;
    EXPECT_NE(choice.error().hint.find("transfer-dc, error"), std::string::npos);
  }
}

using ViewTest = testing::GpuTest;

TEST_F(ViewTest, TransferDcOfAnOpenSphereIsTheClosedFormAllOver) {
  ViewStage stage(openSphere(), {kWhite}, linearOptions({SurfaceView::TransferDc}));
  const spec::RgbaImage image = stage.picture();
  std::size_t count = 0;
  for (const glm::vec4& texel : image.texels) {
    if (texel.a == 0.0f) {
      EXPECT_EQ(texel, glm::vec4(0.0f)) << "no sky in pictures of numbers";
      continue;
    }
    ++count;
    // A_0/pi y_00; the basis is stored in half floats.
    EXPECT_NEAR(texel.r, 0.2820948f, 0.2820948f / 2048.0f);
  }
  EXPECT_GT(count, 300u);
  EXPECT_EQ(stage.frame->legend().max, kOpenDc);
}

TEST_F(ViewTest, ImportanceIsWhatTheBundleRecordsAndNothingWhereNobodySees) {
  BundleBuilder builder = openSphere();
  builder.importance([](const glm::vec3& normal) { return normal.z > 0.0f ? 4.0f : 0.0f; });
  ViewStage stage(builder, {kWhite}, linearOptions({SurfaceView::Importance}));
  stage.camera.azimuth_deg = 90.0f;  // half of what is seen has z > 0
  std::size_t seen = 0, unseen = 0;
  for (const glm::vec4& texel : stage.picture().texels) {
    if (texel.a == 0.0f) continue;
    (texel.r == -1.0f ? unseen : seen) += 1;
    EXPECT_TRUE(texel.r == -1.0f || std::abs(texel.r - 2.0f) < 1e-3f) << texel.r << ", not log2 of 4";
  }
  EXPECT_GT(seen, 100u);
  EXPECT_GT(unseen, 100u);
}

TEST_F(ViewTest, IrradianceIsTheLightWithoutTheAlbedo) {
  ViewStage stage(openSphere(), {kWhite}, linearOptions({SurfaceView::Irradiance}));
  for (const glm::vec4& texel : stage.picture().texels) {
    if (texel.a == 0.0f) continue;
    ASSERT_LT(glm::distance(glm::vec3(texel), glm::vec3(1.0f)), 1e-3f);
  }
}

TEST_F(ViewTest, FalseColoursAreShownAsTheyAreWhateverTheExposure) {
  const auto shown = [](float exposure_ev) {
    FrameOptions options;
    options.settings.exposure_ev = exposure_ev;
    options.view = {SurfaceView::TransferDc};
    ViewStage stage(openSphere(), {kWhite}, options);
    stage.render();
    return stage.frame->readDisplay().texels;
  };
  const auto dark = shown(-6.0f);
  EXPECT_EQ(dark, shown(6.0f));
  // The maximum is at the end of viridis, (253, 231, 37).
  const std::size_t middle = 4 * (32 * 64 + 32);
  EXPECT_NEAR(dark[middle], 253, 4);
  EXPECT_NEAR(dark[middle + 1], 231, 4);
  EXPECT_NEAR(dark[middle + 2], 37, 6);
}

TEST_F(ViewTest, WiresKeepTheCoverageAndLieOnTheSurface) {
  ViewStage stage(BundleBuilder().add({quadMesh(), {}}), {kWhite}, linearOptions());
  const spec::RgbaImage before = stage.picture();
  stage.frame->setView({SurfaceView::Wireframe});
  const spec::RgbaImage wires = stage.picture();
  std::size_t changed = 0;
  for (std::size_t i = 0; i < before.texels.size(); ++i) {
    ASSERT_EQ(wires.texels[i].a, before.texels[i].a);
    if (wires.texels[i] == before.texels[i]) continue;
    ++changed;
    EXPECT_GT(before.texels[i].a, 0.0f) << "only on surfaces";
  }
  // Four edges and a diagonal belong to a quad about 30 pixels wide, and are one to three pixels thick.
  EXPECT_GT(changed, 60u);
  EXPECT_LT(changed, 700u);
}

}  // namespace lambent::frame
