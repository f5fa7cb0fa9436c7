// Tests what is shown in place of baked bundles that do not fit into memory.
#include <algorithm>
#include <cstdint>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/streaming/resident_tables.hpp"
#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using frame::Shown;

constexpr std::uint32_t kSide = 160;
constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

// Makes a box near the camera, on the left; the other scene, farther away to the right, has more vertices.
assets::Scene localScene() {
  assets::Scene scene = testing::named("near");
  testing::add(scene, "box", assets::box({-1.5f, -1.0f, 1.0f}, {-0.5f, 1.0f, 2.0f}, 0.5f), glm::vec3(0.7f),
               glm::vec3(0.0f), /*movable=*/false);
  return scene;
}
assets::Scene farScene() {
  assets::Scene scene = testing::named("far");
  testing::add(scene, "ball", assets::sphere(0.8f, 24), {0.8f, 0.3f, 0.2f}, {1.2f, 0.9f, -1.0f}, true);
  testing::add(scene, "lid", assets::box({0.4f, -1.0f, -1.5f}, {2.0f, -0.6f, -0.5f}, 0.05f),
               {0.2f, 0.5f, 0.7f}, {0.0f, 0.0f, 0.0f}, true);
  return scene;
}

struct Place {
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;

  Place(const std::vector<std::filesystem::path>& bundles, std::uint64_t max_bytes,
        std::uint64_t upload_bytes = std::uint64_t{1} << 24)
      : world({.max_resident_bytes = max_bytes}),
        environment(*lighting::Environment::create(
            {spec::SunLight{
                 .azimuth_deg = 30, .elevation_deg = 50, .angle_deg = 20, .radiance = glm::vec3(6.0f)},
             spec::ConstantLight{.radiance = {0.4f, 0.5f, 0.7f}}})) {
    for (const std::filesystem::path& path : bundles) EXPECT_TRUE(world.open(path));
    frame::FrameOptions options;
    options.size = {kSide, kSide};
    options.output = frame::Output::Linear;
    options.wait_for_captures = true;
    options.upload_budget_bytes = upload_bytes;
    auto made = frame::Frame::create(options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  static spec::View view() {
    const glm::vec3 eye(0.0f, 0.0f, 6.0f);
    return {.view_from_world = glm::lookAt(eye, glm::vec3(0.0f), glm::vec3(0, 1, 0)),
            .clip_from_view = glm::perspective(0.7f, 1.0f, 0.1f, 100.0f),
            .eye_ws = eye};
  }
  void render() {
    world.updateTransforms();
    const Result<void> done = frame->render(world, environment, view());
    ASSERT_TRUE(done) << done.error().line();
  }
  spec::RgbaImage picture() {
    world.updateTransforms();
    world.look(view());
    gpu::Counters counters;
    EXPECT_TRUE(world.uploadAll(counters));
    render();
    EXPECT_TRUE(frame->rest(world, environment));
    render();
    return frame->readLinear();
  }
  Shown shown(std::size_t bundle) const { return world.streaming().bundles[bundle].shown; }
};

// Describes the right half of a picture, where the far bundle is.
struct Right {
  std::vector<bool> covered;
  std::size_t pixels = 0;
  glm::dvec3 mean{0.0};

  explicit Right(const spec::RgbaImage& image) {
    for (std::size_t y = 0; y < image.height; ++y)
      for (std::size_t x = image.width / 2; x < image.width; ++x) {
        const glm::vec4& texel = image.texels[y * image.width + x];
        covered.push_back(texel.a > 0.5f);
        if (!covered.back()) continue;
        ++pixels;
        mean += glm::dvec3(texel);
      }
    if (pixels > 0) mean /= static_cast<double>(pixels);
  }
};

class ProxyLods : public testing::GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    if (IsSkipped()) return;
    std::filesystem::create_directories(folder);
    near = bake(localScene());
    far = bake(farScene());
  }
  void TearDown() override {
    GpuTest::TearDown();
    std::filesystem::remove_all(folder);
  }
  std::filesystem::path bake(const assets::Scene& source) const {
    const std::filesystem::path file = folder / (source.name + ".glb"),
                                path = folder / (source.name + ".lmb.glb");
    EXPECT_TRUE(assets::writeGlb(file, source));
    const auto scene = baker::importScene(file);
    EXPECT_TRUE(scene) << scene.error().line();
    baker::BakeOptions options;
    options.quality = baker::Quality::Draft;
    options.rays = 128;
    options.bounces = 0;
    baker::Progress progress;
    const auto report = baker::bake(*scene, options, path, {progress});
    EXPECT_TRUE(report) << report.error().line();
    return path;
  }
  // There is room for the near bundle and for the proxy level of detail of the far one.
  std::uint64_t tight() const {
    Place alone({near}, kNoLimit);
    alone.picture();
    return alone.world.residency().bytesResident() + (std::uint64_t{64} << 10);
  }

  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) /
      fmt::format("{}-{}", getpid(), ::testing::UnitTest::GetInstance()->current_test_info()->name());
  std::filesystem::path near, far;
};

}  // namespace

TEST_F(ProxyLods, CoverWhatTheBundleCoversInAboutItsLight) {
  Place whole({near, far}, kNoLimit);
  const Right expected(whole.picture());
  ASSERT_GT(expected.pixels, 1000u);
  EXPECT_EQ(whole.shown(1), Shown::Full);

  Place place({near, far}, tight());
  const Right found(place.picture());
  EXPECT_EQ(place.shown(0), Shown::Full);
  ASSERT_EQ(place.shown(1), Shown::ProxyLod);
  const frame::StreamingStatus status = place.world.streaming();
  EXPECT_GT(status.proxy_lod_bytes, 0u);
  EXPECT_LE(status.proxy_lod_bytes,
            2 * (streaming::kProxyLodGroupBytes + 256 * streaming::kProxyLodTriangleBytes));
  EXPECT_LE(status.resident_bytes, status.budget_bytes);
  EXPECT_EQ(status.count(Shown::ProxyLod), 1u);

  std::size_t others = 0;
  for (std::size_t i = 0; i < found.covered.size(); ++i)
    others += found.covered[i] != expected.covered[i] ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(found.pixels), static_cast<double>(expected.pixels),
              0.02 * static_cast<double>(expected.pixels));
  EXPECT_LT(others, expected.pixels / 15) << "and the same ones";
  // The proxy is unshadowed; bodies of this scene hide only a little from each other.
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(found.mean[channel] / expected.mean[channel], 1.0, 0.06) << channel;
}

TEST_F(ProxyLods, GiveWayInOneFrameAndAreNeverSeenTogetherWithTheSurfaces) {
  Place proxy_lod({near, far}, tight());
  const std::vector<bool> before = Right(proxy_lod.picture()).covered;
  Place whole({near, far}, kNoLimit);
  const spec::RgbaImage expected = whole.picture();
  const std::vector<bool> after = Right(expected).covered;
  ASSERT_NE(before, after);

  // There is room for everything, and one item is uploaded per frame.
  const std::uint64_t ample = std::uint64_t{1} << 30;
  Place place({near, far}, ample, /*upload_bytes=*/1);
  int with_proxy_lod = 0, with_surfaces = 0;
  for (int i = 0; i < 2000 && (i < 3 || !place.world.loaded()); ++i) {
    place.render();
    const Right now(place.frame->readLinear());
    if (now.pixels == 0) {
      EXPECT_EQ(with_proxy_lod + with_surfaces, 0);
    } else if (now.covered == before) {
      EXPECT_EQ(with_surfaces, 0);
      ++with_proxy_lod;
    } else {
      ASSERT_EQ(now.covered, after) << "frame " << i;
      ++with_surfaces;
    }
    if (with_proxy_lod + with_surfaces == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GT(with_proxy_lod, 0);
  EXPECT_GT(with_surfaces, 0);
  const spec::RgbaImage found = place.picture();
  EXPECT_EQ(place.shown(1), Shown::Full);
  EXPECT_EQ(place.world.streaming().proxy_lod_bytes, 0u);
  // Light between bodies stays within a thousandth of what it was when it was last captured.
  for (std::size_t i = 0; i < found.texels.size(); ++i)
    ASSERT_LT(glm::distance(found.texels[i], expected.texels[i]), 1e-3f) << i;
  Place at_once({near, far}, ample);
  EXPECT_TRUE(std::ranges::equal(at_once.picture().texels, expected.texels)) << "bit for bit";
}

TEST_F(ProxyLods, AreThoseOfTheReplacementOnceItHasCome) {
  Place place({near, far}, tight());
  const Right before(place.picture());
  ASSERT_TRUE(place.world.replace(1, far));
  EXPECT_EQ(Right(place.picture()).covered, before.covered);
  EXPECT_EQ(place.shown(1), Shown::ProxyLod);
  ASSERT_TRUE(place.world.replace(1, near));  // there is room for all of it
  EXPECT_EQ(Right(place.picture()).pixels, 0u) << "it is on the left";
  EXPECT_EQ(place.shown(1), Shown::Full);
  EXPECT_TRUE(place.world.errors().empty());
}

TEST_F(ProxyLods, FollowTheLightAndTheirPlace) {
  Place place({near, far}, tight());
  const Right before(place.picture());
  ASSERT_EQ(place.shown(1), Shown::ProxyLod);
  place.environment.setIntensity(0.5f);
  place.render();
  const Right dim(place.frame->readLinear());
  EXPECT_EQ(dim.covered, before.covered);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(dim.mean[channel], 0.5 * before.mean[channel], 1e-4);
  place.world.registry().edit<scene::Transform>(place.world.instance(1).root).translation = {0, 0, 200};
  place.render();
  EXPECT_EQ(Right(place.frame->readLinear()).pixels, 0u) << "behind the camera";
}

}  // namespace lambent
