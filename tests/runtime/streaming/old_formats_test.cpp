// Loads bundles of older formats. The golden files are sampleBundle() as the writers of their time wrote it:
// format 5 by version 0.6, format 6 by version 0.7. Nothing can write them again, which is why they are kept.
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "runtime/base/threads.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/streaming/loader.hpp"
#include "tests/runtime/streaming/sample_bundle.hpp"

namespace lambent::streaming {
namespace {

class OldFormats : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  static std::filesystem::path path() {
    return std::filesystem::path(LAMBENT_SOURCE_DIR) / "tests/golden" /
           ("format" + std::to_string(GetParam()) + ".lmb.glb");
  }
};

TEST_P(OldFormats, StillSayTheSame) {
  const auto reader = bundle::Reader::open(path());
  ASSERT_TRUE(reader) << reader.error().line();
  const Result<void> whole = reader->checkAll();
  EXPECT_TRUE(whole) << whole.error().line();
  const bundle::Description &old = reader->description(), now = testing::sampleBundle().description;
  EXPECT_EQ(old.version, GetParam());
  ASSERT_EQ(old.groups.size(), now.groups.size());
  for (std::size_t g = 0; g < now.groups.size(); ++g) {
    EXPECT_EQ(old.groups[g].name, now.groups[g].name);
    EXPECT_EQ(old.groups[g].sample_count, now.groups[g].sample_count);
    ASSERT_EQ(old.groups[g].cells.size(), now.groups[g].cells.size());
  }
  ASSERT_EQ(old.draws.size(), now.draws.size());
  for (std::uint32_t d = 0; d < now.draws.size(); ++d) {
    const auto mesh = reader->readMesh(now.draws[d].mesh, now.draws[d].primitive);
    ASSERT_TRUE(mesh) << mesh.error().line();
    EXPECT_EQ(bundle::meshDigest(*mesh),
              now.meshes[now.draws[d].mesh].primitives[now.draws[d].primitive].digest);
    EXPECT_TRUE(reader->readRows(d));
  }
  const auto codes = reader->readCodebook(bundle::GroupIndex{1}, {}, {});
  ASSERT_TRUE(codes) << codes.error().line();
  EXPECT_EQ(codes->codebook.axis_counts, (std::vector<std::uint32_t>{3, 0}));
  EXPECT_EQ(codes->codebook.vectors[1], 1.0f + 0.5f * 10.0f);
}

TEST_P(OldFormats, AreLoadedInFull) {
  auto reader = bundle::Reader::open(path());
  ASSERT_TRUE(reader) << reader.error().line();
  const bundle::Description& d = reader->description();
  std::size_t planes = 0, items = 0;
  for (const bundle::Group& group : d.groups)
    for (const bundle::Cell& cell : group.cells) planes += 1 + cell.transfers[0].planes.size();
  const std::size_t all =
      3 + d.draws.size() + d.images.size() + d.brdf_tables.size() + planes;  // 3 primitives
  ThreadPool threads;
  Loader loader(std::make_shared<const bundle::Reader>(std::move(*reader)), threads, 2);
  while (!loader.finished()) {
    loader.waitForMore();
    items += loader.take(1 << 20).size();
  }
  EXPECT_FALSE(loader.error());
  EXPECT_EQ(items, all);
}

INSTANTIATE_TEST_SUITE_P(Golden, OldFormats,
                         ::testing::Values(bundle::kVersionVolumesAndNeighborhoods,
                                           bundle::kVersionWeightedNormals));

}  // namespace
}  // namespace lambent::streaming
