// Tests the loading of volumes' grids: their order, validation, and blocks.
#include <algorithm>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/streaming/loader.hpp"
#include "runtime/streaming/parts.hpp"
#include "runtime/streaming/sizes.hpp"
#include "tests/runtime/streaming/sample_bundle.hpp"
#include "tests/support/built_volume.hpp"

namespace lambent::streaming {
namespace {

using lambent::testing::BuiltVolume;

BuiltVolume waves() {
  BuiltVolume volume;
  volume.size = {11, 9, 20};
  volume.density = [](const glm::vec3& at) { return 0.5f + 0.5f * std::sin(at.x + 3.0f * at.y - at.z); };
  volume.transfer_size = {4, 3, 5};
  volume.has_sample = [](std::uint32_t voxel) { return voxel % 3 != 1; };
  return volume;
}

class VolumeLoading : public ::testing::Test {
 protected:
  std::shared_ptr<const bundle::Reader> write(const testing::Sample& sample) {
    const auto path = folder_ / "scene.lmb.glb";
    const auto written = bundle::write(path, sample.description, sample.blobs);
    EXPECT_TRUE(written) << written.error().line();
    auto reader = bundle::Reader::open(path);
    EXPECT_TRUE(reader) << reader.error().line();
    return reader ? std::make_shared<const bundle::Reader>(std::move(*reader)) : nullptr;
  }
  static std::vector<Ready> drain(Loader& loader) {
    std::vector<Ready> all;
    while (!loader.finished()) {
      loader.waitForMore();
      for (Ready& item : loader.take(std::size_t{1} << 20)) all.push_back(std::move(item));
      if (loader.error()) break;
    }
    return all;
  }

  testing::TemporaryFolder folder_;
  ThreadPool threads_;
};

}  // namespace

TEST_F(VolumeLoading, BringsGridsAsTheyWereWrittenBeforeImagesAndTransfer) {
  for (const std::uint32_t bits : {8u, 16u}) {
    testing::Sample sample = testing::sampleBundle();
    BuiltVolume volume = waves();
    volume.bits = bits;
    const std::uint32_t group = lambent::testing::addVolume(sample.description, sample.blobs, volume);
    Loader loader(write(sample), threads_, 3);
    const std::vector<Ready> items = drain(loader);
    ASSERT_FALSE(loader.error()) << loader.error()->line();
    const auto placeOf = [&](const auto& is) {
      return std::find_if(items.begin(), items.end(), is) - items.begin();
    };
    const auto density =
        placeOf([](const Ready& item) { return std::holds_alternative<DensityChunk>(item); });
    const auto voxels = placeOf([](const Ready& item) { return std::holds_alternative<VoxelsChunk>(item); });
    const auto image = placeOf([](const Ready& item) { return std::holds_alternative<ImageChunk>(item); });
    const auto brdf = placeOf([](const Ready& item) { return std::holds_alternative<BrdfChunk>(item); });
    EXPECT_LT(brdf, density);
    EXPECT_EQ(density + 1, voxels);
    EXPECT_LT(voxels, image);
    ASSERT_LT(image, static_cast<std::ptrdiff_t>(items.size()));
    const auto& found = std::get<DensityChunk>(items[static_cast<std::size_t>(density)]);
    EXPECT_EQ(found.group, bundle::GroupIndex{group});
    EXPECT_EQ(found.codes, volume.codes());
    EXPECT_EQ(found.block_maxima.size(), 2u * 2u * 3u);
    EXPECT_EQ(std::get<VoxelsChunk>(items[static_cast<std::size_t>(voxels)]).voxels, volume.voxels());
  }
}

TEST_F(VolumeLoading, CountsGridsAndTheirLightAgainstTheBudget) {
  testing::Sample sample;
  BuiltVolume volume = waves();
  volume.shape.outputs = 9;
  volume.bits = 8;
  lambent::testing::addVolume(sample.description, sample.blobs, volume);
  const auto samples = static_cast<std::uint64_t>(volume.voxels().size());
  // Densities become 16 bits on the GPU; light is four half floats per texel and output.
  EXPECT_EQ(needsOf(sample.description).volumes, 2 * 11 * 9 * 20 + 4 * samples + 8 * 9 * 4 * 3 * 5);
  const auto reader = write(sample);
  const auto parts = partsOf(*reader, /*limited=*/true);
  ASSERT_TRUE(parts);
  EXPECT_GE(parts->units[0][0].bytes, needsOf(sample.description).volumes)
      << "what it takes to show it comes first";
}

TEST(VolumeBlocks, HoldTheLargestDensityThatIsFoundInThem) {
  std::mt19937 engine(3);
  for (const glm::uvec3 size : {glm::uvec3(1, 1, 1), glm::uvec3(8, 8, 8), glm::uvec3(17, 9, 26)})
    for (const std::uint32_t bits : {8u, 16u}) {
      std::vector<std::uint32_t> codes(std::size_t{size.x} * size.y * size.z, 0);
      for (std::uint32_t& code : codes)
        if (engine() % 40 == 0) code = static_cast<std::uint32_t>(engine()) % (1u << bits);
      std::vector<std::byte> bytes;
      for (const std::uint32_t code : codes) {
        bytes.push_back(static_cast<std::byte>(code & 0xff));
        if (bits == 16) bytes.push_back(static_cast<std::byte>(code >> 8));
      }
      const std::vector<float> found = blockMaxima(bytes, bits, size);
      const glm::uvec3 blocks = blocksOf(size);
      ASSERT_EQ(found.size(), std::size_t{blocks.x} * blocks.y * blocks.z);
      for (std::uint32_t b = 0; b < found.size(); ++b) {
        const glm::ivec3 first =
            8 * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y)) - 1;
        const glm::ivec3 low = glm::max(first, 0), high = glm::min(first + 9, glm::ivec3(size) - 1);
        std::uint32_t most = 0;
        for (int z = low.z; z <= high.z; ++z)
          for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
              most = std::max(most, codes[static_cast<std::size_t>(x) +
                                          size.x * (static_cast<std::size_t>(y) +
                                                    std::size_t{size.y} * static_cast<std::size_t>(z))]);
        EXPECT_EQ(found[b], static_cast<float>(most) / (bits == 16 ? 65535.0f : 255.0f));
      }
    }
}

}  // namespace lambent::streaming
