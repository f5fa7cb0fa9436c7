// Tests that an interrupted bake of a volume resumes and gives a bit-identical result.
#include <atomic>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "baker/effects/volume/volume.hpp"

namespace lambent::baker {
namespace {

class VolumeCheckpoint : public ::testing::TestWithParam<float> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("lambent-volume-" + std::to_string(::getpid()) + "-" + std::to_string(GetParam() > 0.5f));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Makes a ball, denser in its middle, that scatters nearly all light, with a colour.
  static Medium ball() {
    static const glm::uvec3 size(16);
    static const std::vector<float> values = [] {
      std::vector<float> density;
      for (unsigned z = 0; z < size.z; ++z)
        for (unsigned y = 0; y < size.y; ++y)
          for (unsigned x = 0; x < size.x; ++x) {
            const glm::vec3 at = (glm::vec3(x, y, z) + 0.5f) / 16.0f - 0.5f;
            density.push_back(std::max(0.0f, 30.0f * (0.4f - glm::length(at))));
          }
      return density;
    }();
    const auto field = std::make_shared<DensityField>(size, values, glm::mat4(1.0f / 16.0f));
    return {field, values, {0.99f, 0.9f, 0.8f}, GetParam()};
  }
  static VolumeSettings settings() {
    return {.order = 3, .rays = 256, .scatterings = -1, .grid = glm::uvec3(10), .memory = 1u << 26};
  }
  Cache open() const {
    auto cache = Cache::open(folder_);
    EXPECT_TRUE(cache) << cache.error().line();
    cache->beginBake();
    cache->setCheckpointEvery(0.0);  // all the time
    return std::move(*cache);
  }
  std::ptrdiff_t entries() const {
    std::ptrdiff_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      files += entry.is_regular_file();
    return files;
  }

  std::filesystem::path folder_;
};

}  // namespace

TEST_P(VolumeCheckpoint, CutShortAgainAndAgainItComesToTheSameBits) {
  Progress progress;
  const auto whole = bakeVolumeTransfer(ball(), settings(), {}, {progress});
  ASSERT_TRUE(whole);
  ASSERT_GT(whole->iterations, 5);
  int runs = 0;
  std::uint64_t rays = 0;
  std::optional<VolumeTransfer> last;
  // Each run is stopped a little later than the last, and starts from what was kept.
  for (; !last; ++runs) {
    ASSERT_LT(runs, 2000);
    Cache cache = open();
    const Key key = KeyMaker().addText("ball").key();
    std::stop_source stop;
    std::atomic<bool> done = false;
    std::thread killer([&] {
      for (int waited_us = 0; waited_us < 2000 + 500 * runs && !done; waited_us += 200)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      stop.request_stop();
    });
    last = bakeVolumeTransfer(ball(), settings(), {}, {progress, stop.get_token(), &cache, key});
    done = true;
    killer.join();
    if (last) rays = last->rays;
  }
  EXPECT_GT(runs, 2) << "it was never cut short";
  EXPECT_EQ(last->vectors, whole->vectors);
  EXPECT_EQ(last->visibility, whole->visibility);
  EXPECT_EQ(last->iterations, whole->iterations);
  EXPECT_EQ(last->residual, whole->residual);
  EXPECT_LT(rays, whole->rays) << "the last run found what others had traced";
  EXPECT_EQ(last->rays + last->rays_kept, whole->rays);
  EXPECT_EQ(entries(), 1) << "checkpoints go when the result is there";
  Cache cache = open();
  const auto found =
      bakeVolumeTransfer(ball(), settings(), {}, {progress, {}, &cache, KeyMaker().addText("ball").key()});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->rays, 0u);
  EXPECT_EQ(found->vectors, whole->vectors);
}

INSTANTIATE_TEST_SUITE_P(PhaseFunctions, VolumeCheckpoint, ::testing::Values(0.0f, 0.4f));

}  // namespace lambent::baker
