// Tests that volumes and neighborhoods are read back from a bundle as they were written, and that
// contradictions are refused by name.
#include <gtest/gtest.h>

#include "runtime/bundle/description.hpp"
#include "tests/runtime/bundle/bundle_file.hpp"

namespace lambent::bundle {
namespace {

const std::vector<std::uint32_t> kVoxels = {0, 1, 5, 7};

// Makes a body with two plain samples and a neighborhood of eight points, and a cloud of 4 x 3 x 2 voxels
// with four samples on a transfer grid of 2 x 2 x 2, within the first group.
Sample gridSample() {
  Sample s;
  Description& d = s.description;
  d.generator = {"lambent", "0.5.0", "x86-64-v3", {}};
  d.nodes.resize(2);
  d.roots = {0, 1};
  const auto transfer = [&](const transfer::TransferShape& shape) { return s.meanTransfer(shape); };
  Group body;
  body.name = "body";
  body.sample_count = 10;
  body.cells = {
      {.first_sample = 0, .sample_count = 2, .transfers = {transfer({.order = 3})}},
      {.first_sample = 2,
       .sample_count = 8,
       .transfers = {transfer({.order = 3, .outputs = 9, .visibility_bands = 5}),
                     transfer({.order = 3, .shadowed_channels = 0, .full_channels = 3, .outputs = 9})},
       .domain = transfer::Domain::GridPoint}};
  body.neighborhood =
      NeighborhoodGrid{{2, 2, 2}, glm::vec3(-1.0f, -2.0f, -3.0f), glm::vec3(1.0f, 2.0f, 3.0f)};
  Group cloud;
  cloud.name = "cloud";
  cloud.node = 1;
  cloud.sample_count = 4;
  cloud.cells = {{.first_sample = 0,
                  .sample_count = 4,
                  .transfers = {transfer({.order = 3, .full_channels = 3})},
                  .domain = transfer::Domain::Voxel}};
  VolumeGrid grid;
  grid.size = {4, 3, 2};
  grid.group_from_grid[3] = glm::vec4(7.0f, 8.0f, 9.0f, 1.0f);
  grid.bits = 16;
  grid.density_max = 12.5f;
  grid.albedo = {0.9f, 0.8f, 0.7f};
  grid.g = -0.25f;
  grid.transfer_size = {2, 2, 2};
  grid.density = s.add(PayloadType::Density, Blob(2 * 24, std::byte{7}));
  grid.voxels = s.add(PayloadType::Voxels, encodeVoxels(kVoxels));
  cloud.volume = grid;
  cloud.within = 0;
  d.groups = {body, cloud};
  return s;
}

using Grids = BundleFile;

TEST_F(Grids, ComeBackAsTheyWereWritten) {
  const Sample sample = gridSample();
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_TRUE(reader->checkAll());
  const Group& body = reader->description().groups[0];
  const Group& cloud = reader->description().groups[1];
  EXPECT_EQ(body.cells[1].domain, transfer::Domain::GridPoint);
  EXPECT_EQ(body.samplesOf(transfer::Form::Vector), 2u);
  EXPECT_EQ(body.samplesOf(transfer::Form::NormalMapped), 0u)
      << "points of a grid are no samples of normal maps";
  ASSERT_TRUE(body.neighborhood);
  EXPECT_EQ(body.neighborhood->size, glm::uvec3(2));
  EXPECT_EQ(body.neighborhood->bounds_max, glm::vec3(1.0f, 2.0f, 3.0f));
  EXPECT_FALSE(body.volume);
  EXPECT_EQ(body.within, -1);
  ASSERT_TRUE(cloud.volume);
  EXPECT_EQ(cloud.within, 0);
  EXPECT_EQ(cloud.volume->size, glm::uvec3(4, 3, 2));
  EXPECT_EQ(cloud.volume->group_from_grid, sample.description.groups[1].volume->group_from_grid);
  EXPECT_EQ(cloud.volume->bits, 16u);
  EXPECT_EQ(cloud.volume->density_max, 12.5f);
  EXPECT_EQ(cloud.volume->albedo, glm::vec3(0.9f, 0.8f, 0.7f));
  EXPECT_EQ(cloud.volume->g, -0.25f);
  const auto bytes = reader->readPayload(cloud.volume->voxels);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(decodeVoxels(*bytes, cloud.volume->transfer_size, "voxels").value(), kVoxels);
}

TEST_F(Grids, ThatContradictThemselvesAreRefusedByName) {
  const auto refused = [&](auto spoil, const char* place) {
    Sample sample = gridSample();
    spoil(sample.description.groups[0], sample.description.groups[1], *sample.description.groups[1].volume);
    BundleFile::refused(sample, place);
  };
  refused([](Group&, Group&, VolumeGrid& v) { v.size.x = 5; }, "volume.density");
  refused([](Group&, Group&, VolumeGrid& v) { v.size.x = 0; }, "volume.size");
  refused([](Group&, Group&, VolumeGrid& v) { v.bits = 12; }, "volume.bits");
  refused([](Group&, Group&, VolumeGrid& v) { v.group_from_grid[1] = glm::vec4(0.0f); }, "volume.matrix");
  refused([](Group&, Group&, VolumeGrid& v) { v.density_max = -1.0f; }, "volume.densityMax");
  refused([](Group&, Group&, VolumeGrid& v) { v.albedo.g = 1.5f; }, "volume.albedo");
  refused([](Group&, Group&, VolumeGrid& v) { v.g = 1.0f; }, "volume.g");
  refused([](Group&, Group&, VolumeGrid& v) { v.transfer_size.z = 300; }, "volume.transferSize");
  refused([](Group&, Group&, VolumeGrid& v) { v.voxels = v.density; }, "volume.voxels");
  refused([](Group&, Group& cloud, VolumeGrid&) { cloud.volume.reset(); }, "a volume that is not there");
  refused([](Group& body, Group&, VolumeGrid&) { body.within = 1; }, "within");
  refused([](Group& body, Group&, VolumeGrid&) { body.neighborhood.reset(); },
          "the points of the neighborhood");
  refused([](Group& body, Group&, VolumeGrid&) { body.neighborhood->size.x = 3; },
          "the points of the neighborhood");
  refused([](Group& body, Group&, VolumeGrid&) { body.neighborhood->size.x = 1; }, "neighborhood.size");
  refused([](Group& body, Group&, VolumeGrid&) { body.neighborhood->bounds_max.y = -2.0f; },
          "neighborhood.boundsMax");
  refused([](Group& body, Group&, VolumeGrid&) { body.cells[0].domain = transfer::Domain::GridPoint; },
          "after the environment");
  refused([](Group& body, Group&, VolumeGrid&) { body.cells[1].transfers[0].shape.visibility_bands = 6; },
          "visibilityBands");
}

TEST(Voxels, OutOfOrderOrOutsideTheGridAreRefused) {
  const glm::uvec3 grid(2, 2, 2);
  EXPECT_EQ(decodeVoxels(encodeVoxels(kVoxels), grid, "v").value(), kVoxels);
  EXPECT_TRUE(decodeVoxels(encodeVoxels({}), grid, "v").value().empty());
  for (const std::vector<std::uint32_t>& voxels :
       {std::vector<std::uint32_t>{0, 0}, std::vector<std::uint32_t>{3, 2}, std::vector<std::uint32_t>{8},
        std::vector<std::uint32_t>{0xffffffffu}})
    EXPECT_FALSE(decodeVoxels(encodeVoxels(voxels), grid, "v"));
  std::vector<std::byte> cut = encodeVoxels(kVoxels);
  cut.pop_back();
  EXPECT_FALSE(decodeVoxels(cut, grid, "v"));
}

}  // namespace
}  // namespace lambent::bundle
