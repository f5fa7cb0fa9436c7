#include "runtime/streaming/loader.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/bundle/container.hpp"
#include "runtime/streaming/parts.hpp"
#include "runtime/streaming/resident_tables.hpp"
#include "tests/runtime/streaming/sample_bundle.hpp"
#include "tests/support/built_volume.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::streaming {
namespace {

using testing::Sample;

using lambent::testing::BuiltVolume;

struct Name {
  std::string operator()(const MeshRequest& r) const {
    return fmt::format("mesh {}.{}", r.mesh, r.primitive);
  }
  std::string operator()(const ImageRequest& r) const { return fmt::format("image {}", r.image); }
  std::string operator()(const WeightsRequest& r) const { return fmt::format("rows {}", r.draw); }
  std::string operator()(const CodebookRequest& r) const { return "codebook" + placeOf(r); }
  std::string operator()(const PlaneRequest& r) const {
    return fmt::format("plane{}.{}", placeOf(r), r.plane.value);
  }
  std::string operator()(const LightWeightsRequest& r) const {
    return fmt::format("light weights {}.{}", r.group.value, r.cell.value);
  }
  std::string operator()(const ProxyRequest& r) const { return fmt::format("proxy {}", r.group.value); }
  std::string operator()(const BrdfRequest& r) const { return fmt::format("brdf {}", r.table); }
  std::string operator()(const DensityRequest& r) const { return fmt::format("density {}", r.group.value); }
  std::string operator()(const VoxelsRequest& r) const { return fmt::format("voxels {}", r.group.value); }
  static std::string placeOf(const CodebookRequest& r) {
    return fmt::format(" {}.{}.{}", r.group.value, r.cell.value, r.transfer.value);
  }
};

std::vector<std::string> names(const std::vector<Ready>& items) {
  std::vector<std::string> all;
  for (const Ready& item : items) all.push_back(std::visit(Name{}, item));
  return all;
}

const std::vector<std::string> kInOrder = {
    "mesh 0.0",       "mesh 1.0",       "mesh 1.1",       // by place
    "rows 1",         "rows 0",         "rows 2",         // priorities 2, 3, 3
    "brdf 0",         "image 0",        "image 1",        // by place
    "codebook 1.0.0", "plane 1.0.0.0",  "plane 1.0.0.1",  // 10, 12, 11: never before plane 0
    "codebook 0.0.0", "codebook 1.1.0", "plane 1.1.0.0",  // 20, 20, 5: never before its codebook
    "plane 0.0.0.0",  "plane 1.0.0.2",  "plane 0.0.0.1",  // 21, 30, 40
};

class LoaderTest : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "scene.lmb.glb"; }

  void write(const Sample& sample) {
    const auto written = bundle::write(path(), sample.description, sample.blobs);
    ASSERT_TRUE(written) << written.error().line();
  }
  std::shared_ptr<const bundle::Reader> open() const {
    auto reader = bundle::Reader::open(path());
    EXPECT_TRUE(reader) << reader.error().line();
    return reader ? std::make_shared<const bundle::Reader>(std::move(*reader)) : nullptr;
  }
  // Takes everything, as a frame loop would.
  static std::vector<Ready> drain(Loader& loader, std::size_t max_bytes) {
    std::vector<Ready> all;
    while (!loader.finished()) {
      loader.waitForMore();
      for (Ready& item : loader.take(max_bytes)) all.push_back(std::move(item));
    }
    EXPECT_TRUE(loader.take(max_bytes).empty());
    loader.waitForMore();  // returns at once
    return all;
  }
  // Flips one bit of a view in the file.
  void damage(std::uint32_t view) const {
    std::size_t at = std::string::npos;
    {
      const auto reader = open();
      ASSERT_TRUE(reader);
      std::ifstream in(path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(in)), {});
      const auto wanted = reader->readView(view);
      ASSERT_TRUE(wanted);
      at = bytes.find(std::string(reinterpret_cast<const char*>(wanted->data()), wanted->size()));
      ASSERT_NE(at, std::string::npos);
      at += wanted->size() / 2;
    }
    std::fstream file(path(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(at));
    const char byte = static_cast<char>(file.get() ^ 4);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
  }

  ThreadPool threads_;

 private:
  lambent::testing::TemporaryFolder folder_;
};

TEST_F(LoaderTest, DeliversByPriorityWhatWasWritten) {
  const Sample sample = testing::sampleBundle();
  write(sample);
  Loader loader(open(), threads_, 2);
  const auto items = drain(loader, 1 << 20);
  EXPECT_EQ(names(items), kInOrder);
  EXPECT_FALSE(loader.error());
  ASSERT_EQ(items.size(), kInOrder.size());
  const auto& mesh = std::get<MeshChunk>(items[2]).data;
  ASSERT_EQ(mesh.positions.size(), 52u);
  EXPECT_NEAR(mesh.positions[0].y, 3.0f, 1e-6f);
  const BrdfChunk& table = std::get<BrdfChunk>(items[6]);
  ASSERT_EQ(table.data.values.size(), testing::brdfTable().values.size());
  EXPECT_NEAR(table.data.values[77], 0.077f, 1e-5f);
  EXPECT_EQ(table.texels.width, 3u);
  EXPECT_EQ(table.texels.height, 2u);
  EXPECT_EQ(table.texels.layers, 5u) << "twenty weights of a node, four to a texel";
  const auto& rows = std::get<WeightsChunk>(items[4]).rows;
  ASSERT_EQ(rows.samples.size(), 402u);
  EXPECT_EQ(rows.samples[401], 101u);
  const auto& image = std::get<ImageChunk>(items[7]);
  EXPECT_EQ(image.width, 20u);
  EXPECT_EQ(image.height, 10u);
  EXPECT_EQ(image.rgba[(9 * 20 + 19) * 4 + 2], testing::texel(19, 9, 2));
  const auto& codebook = std::get<CodebookChunk>(items[9]);
  ASSERT_EQ(codebook.codebook.vectors.size(), 20u);
  EXPECT_EQ(codebook.codebook.vectors[19], 24.0f) << "19 + 10/2: exact in binary16";
  EXPECT_EQ(codebook.codebook.axes.size(), 3u);
  ASSERT_EQ(codebook.positions.size(), 500u);
  EXPECT_EQ(codebook.positions[0], 1u) << "sample 0 is of the second cluster";
  EXPECT_EQ(codebook.positions[332], 499u) << "333 samples of the first cluster";
  EXPECT_EQ(codebook.positions[333], 0u | 1u << 16);
  EXPECT_EQ(codebook.positions[499], 498u | 1u << 16);
  const auto& codes = std::get<PlaneChunk>(items[11]).codes;
  ASSERT_EQ(codes.size(), 666u) << "333 samples of 16 bits";
  std::uint16_t code = 0;
  std::memcpy(&code, &codes[2 * 332], sizeof code);
  EXPECT_EQ(code, 31 * 332 + 11);
}

TEST_F(LoaderTest, GivesTheSameSequenceForAnyNumberOfThreadsAndAnyBudget) {
  write(testing::sampleBundle());
  for (const unsigned threads : {0u, 1u, 3u, 16u, 64u}) {
    for (const std::size_t budget : {std::size_t{1}, std::size_t{5000}, std::size_t{1} << 30}) {
      Loader loader(open(), threads_, threads);
      EXPECT_EQ(names(drain(loader, budget)), kInOrder) << threads << " threads";
    }
  }
}

TEST_F(LoaderTest, DecodesNoFurtherAheadThanItsMemory) {
  constexpr std::uint32_t kThreads = 4;
  write(testing::manyImages(48, 1024));  // 4 MiB each: 192 MiB in all, of which 64 fit
  Loader loader(open(), threads_, kThreads);
  loader.waitForMore();
  // Time to go too far; how far it gets is bounded however long this is.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const std::size_t ahead = loader.take(~std::size_t{0}).size();
  EXPECT_LE(ahead, 16u + 1u);
  EXPECT_EQ(ahead + drain(loader, std::size_t{16} << 20).size(), 48u);
  EXPECT_FALSE(loader.error());
}

TEST_F(LoaderTest, IsDestroyedMidWayWithoutHanging) {
  write(testing::manyImages(40, 1024));  // more than its memory: workers wait for room
  const auto reader = open();
  for (std::size_t take = 0; take < 4; ++take) {
    Loader loader(reader, threads_, 4);
    std::size_t taken = 0;
    while (taken < take) {
      loader.waitForMore();
      taken += loader.take(1).size();
    }
    EXPECT_EQ(taken, take) << "one at a time";
    EXPECT_FALSE(loader.finished()) << "it is mid way";
    EXPECT_FALSE(loader.error());
  }
  EXPECT_EQ(reader.use_count(), 1) << "no worker is left that holds the file";
}

TEST_F(LoaderTest, StopsAtADamagedPayloadAndNamesTheFileWhateverTheThreads) {
  const Sample sample = testing::sampleBundle();
  write(sample);
  const bundle::Description& d = sample.description;
  damage(d.payloads[d.groups[1].cells[0].transfers[0].planes[0].payload].view);  // "plane 1.0.0.0"
  damage(d.payloads[d.groups[0].cells[0].transfers[0].planes[1].payload].view);  // and the last of all
  const std::vector<std::string> before(kInOrder.begin(), kInOrder.begin() + 10);
  std::string first_line;
  for (const unsigned threads : {1u, 8u}) {
    Loader loader(open(), threads_, threads);
    EXPECT_EQ(names(drain(loader, 1 << 20)), before);
    ASSERT_TRUE(loader.error());
    const std::string line = loader.error()->line();
    EXPECT_NE(line.find(path().string()), std::string::npos) << line;
    if (!first_line.empty()) {
      EXPECT_EQ(line, first_line) << "the first damage in order, not in time";
    }
    first_line = line;
  }
}

TEST_F(LoaderTest, BringsThePartsThatAreAskedForInTheirOrder) {
  write(testing::sampleBundle());
  Loader loader(open(),
                {ImageRequest{1}, MeshRequest{1, 1}, CodebookRequest{bundle::GroupIndex{1}, {}, {}},
                 PlaneRequest{{bundle::GroupIndex{1}, {}, {}}, {}}},
                threads_, 2);
  EXPECT_EQ(names(drain(loader, 1 << 20)),
            (std::vector<std::string>{"image 1", "mesh 1.1", "codebook 1.0.0", "plane 1.0.0.0"}));
}

TEST_F(LoaderTest, PartsOfABundleAreAllOfItEachOnceInAnOrderThatShows) {
  write(testing::sampleBundle());
  const auto reader = open();
  const auto parts = partsOf(*reader, /*limited=*/true);
  ASSERT_TRUE(parts) << parts.error().line();
  const bundle::Description& d = reader->description();
  ASSERT_EQ(parts->units.size(), 1 + d.groups.size() + d.images.size());
  std::vector<Work> all;
  for (const Unit& unit : parts->units)
    for (const Step& step : unit) {
      EXPECT_GT(step.bytes, 0u);
      all.insert(all.end(), step.work.begin(), step.work.end());
    }
  Loader loader(reader, all, threads_, 2);
  std::vector<std::string> found = names(drain(loader, 1 << 20));
  EXPECT_FALSE(loader.error());
  std::vector<std::string> expected = kInOrder;
  std::ranges::sort(found);
  std::ranges::sort(expected);
  EXPECT_EQ(found, expected);
  for (std::uint32_t g = 0; g < d.groups.size(); ++g) {
    const bundle::Group& group = reader->description().groups[g];
    for (std::uint32_t c = 0; c < group.cells.size(); ++c)
      for (std::uint32_t t = 0; t < group.cells[c].transfers.size(); ++t) {
        const auto planesIn = [&](std::size_t steps) {
          return parts->planesIn(bundle::GroupIndex{g}, static_cast<std::uint32_t>(steps),
                                 bundle::CellIndex{c}, bundle::TransferIndex{t});
        };
        EXPECT_EQ(planesIn(parts->units[1 + g].size()), group.cells[c].transfers[t].planes.size());
        EXPECT_EQ(planesIn(1), 0u) << "codebooks first";
      }
  }
}

// Loads as a camera that wanders would: any parts in any order, by several loaders at once on the same
// threads, some dropped before they are done.
TEST_F(LoaderTest, BringsRandomPartsWhileOthersAreDropped) {
  write(testing::sampleBundle());
  const auto reader = open();
  const auto parts = partsOf(*reader, /*limited=*/true);
  ASSERT_TRUE(parts);
  std::vector<Work> all;
  for (const Unit& unit : parts->units)
    for (const Step& step : unit) all.insert(all.end(), step.work.begin(), step.work.end());
  std::mt19937 random(7);
  std::vector<std::unique_ptr<Loader>> dropped;
  for (int loads = 0; loads < 200; ++loads) {
    std::ranges::shuffle(all, random);
    const std::size_t count = 1 + random() % all.size();
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
    auto loader = std::make_unique<Loader>(reader, std::vector<Work>(all.begin(), end), threads_,
                                           static_cast<unsigned>(1 + random() % 3));
    if (random() % 2 == 0) {
      EXPECT_EQ(drain(*loader, 1 + random() % 20'000).size(), count);
      EXPECT_FALSE(loader->error());
      continue;
    }
    if (random() % 2 == 0) loader->waitForMore(std::chrono::milliseconds(random() % 3));
    loader->take(1 + random() % 5'000);
    loader->stop();
    dropped.push_back(std::move(loader));
    std::erase_if(dropped, [](const auto& one) { return one->idle(); });
  }
}

BuiltVolume waves() {
  BuiltVolume volume;
  volume.size = {11, 9, 20};
  volume.density = [](const glm::vec3& at) { return 0.5f + 0.5f * std::sin(at.x + 3.0f * at.y - at.z); };
  volume.transfer_size = {4, 3, 5};
  volume.has_sample = [](std::uint32_t voxel) { return voxel % 3 != 1; };
  return volume;
}

TEST_F(LoaderTest, BringsGridsAsTheyWereWrittenBeforeImagesAndTransfer) {
  for (const std::uint32_t bits : {8u, 16u}) {
    testing::Sample sample = testing::sampleBundle();
    BuiltVolume volume = waves();
    volume.bits = bits;
    const std::uint32_t group = lambent::testing::addVolume(sample.description, sample.blobs, volume);
    write(sample);
    Loader loader(open(), threads_, 3);
    const std::vector<Ready> items = drain(loader, 1 << 20);
    ASSERT_FALSE(loader.error()) << loader.error()->line();
    const auto placeOf = [&]<class Chunk>() {
      return std::ranges::find_if(items,
                                  [](const Ready& item) { return std::holds_alternative<Chunk>(item); }) -
             items.begin();
    };
    const auto density = placeOf.template operator()<DensityChunk>(),
               voxels = placeOf.template operator()<VoxelsChunk>(),
               image = placeOf.template operator()<ImageChunk>(),
               brdf = placeOf.template operator()<BrdfChunk>();
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

TEST_F(LoaderTest, CountsGridsAndTheirLightAgainstTheBudget) {
  testing::Sample sample;
  BuiltVolume volume = waves();
  volume.shape.outputs = 9;
  volume.bits = 8;
  lambent::testing::addVolume(sample.description, sample.blobs, volume);
  const auto samples = static_cast<std::uint64_t>(volume.voxels().size());
  // Densities become 16 bits on the GPU; light is four half floats per texel and output.
  EXPECT_EQ(needsOf(sample.description).volumes, 2 * 11 * 9 * 20 + 4 * samples + 8 * 9 * 4 * 3 * 5);
  write(sample);
  const auto parts = partsOf(*open(), /*limited=*/true);
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

}  // namespace
}  // namespace lambent::streaming
