// Tests that volumes, neighborhoods and glossy parts are read back from a bundle as they were written, and
// that contradictions are refused by name.
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

// Tests that the glossy parts of a bundle are read back as they were written, and that contradictions are
// refused by name.

// Makes one plain cell of two samples and one glossy cell of three, with visibility, bounced light, a lamp,
// and two tables.
Sample glossySample() {
  Sample s;
  Description& d = s.description;
  d.generator = {"lambent", "0.4.0", "x86-64-v3", {{"glossyOrder", "4"}}};
  d.nodes.resize(1);
  d.roots = {0};
  d.nodes[0].light = 0;
  d.lights.resize(1);
  const auto transfer = [&](const transfer::TransferShape& shape) { return s.meanTransfer(shape); };
  Group group;
  group.sample_count = 5;
  group.lights = {{GroupLight::Kind::Node, 0, glm::vec3(1.0f)}};
  Cell plain{.first_sample = 0, .sample_count = 2, .transfers = {transfer({.order = 3})}};
  Cell glossy{.first_sample = 2,
              .sample_count = 3,
              .transfers = {transfer({.order = 3, .outputs = 16, .visibility_bands = 6}),
                            transfer({.order = 3, .shadowed_channels = 0, .full_channels = 3, .outputs = 16}),
                            transfer({.order = 0, .light_columns = 1, .outputs = 16})}};
  group.cells = {plain, glossy};
  d.groups = {group};
  const BrdfTable table{.order = 4, .lobes = 2, .angles = 2, .values = std::vector<float>(40, 0.1f)};
  d.brdf_tables = {
      {BrdfFamily::Measured, "acryl_blue.brdf", s.add(PayloadType::BrdfTable, encodeBrdfTable(table))},
      {BrdfFamily::Ggx, "", s.add(PayloadType::BrdfTable, encodeBrdfTable(table))}};
  return s;
}

using GlossyParts = BundleFile;

TEST_F(GlossyParts, ComeBackAsTheyWereWritten) {
  const Sample sample = glossySample();
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_TRUE(reader->checkAll());
  const Description& d = reader->description();
  ASSERT_EQ(d.brdf_tables.size(), 2u);
  EXPECT_EQ(d.brdf_tables[0].family, BrdfFamily::Measured);
  EXPECT_EQ(d.brdf_tables[0].name, "acryl_blue.brdf");
  EXPECT_EQ(d.brdf_tables[1].family, BrdfFamily::Ggx);
  const auto table = reader->readBrdfTable(1);
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->order, 4u);
  const Group& group = d.groups[0];
  EXPECT_EQ(group.samplesOf(transfer::Form::Vector), 2u);
  EXPECT_EQ(group.samplesOf(transfer::Form::Matrix), 3u);
  ASSERT_EQ(group.cells[1].transfers.size(), 3u);
  for (std::size_t t = 0; t < 3; ++t)
    EXPECT_EQ(group.cells[1].transfers[t].shape, sample.description.groups[0].cells[1].transfers[t].shape);
  EXPECT_EQ(group.cells[1].transfers[0].shape.size(), 36u) << "visibility in 3 + 4 - 1 bands";
  EXPECT_EQ(group.cells[1].transfers[1].shape.size(), 3u * 16u * 9u);
}

TEST_F(GlossyParts, ThatContradictThemselvesAreRefusedByName) {
  const auto refused = [&](auto spoil, const char* place) {
    Sample sample = glossySample();
    spoil(sample.description);
    BundleFile::refused(sample, place);
  };
  const auto glossy = [](Description& d) -> std::vector<CellTransfer>& {
    return d.groups[0].cells[1].transfers;
  };
  refused([&](Description& d) { glossy(d)[0].shape.visibility_bands = 5; }, "visibilityBands");
  refused([&](Description& d) { glossy(d)[0].shape.full_channels = 3; }, "visibilityBands");
  refused([&](Description& d) { glossy(d)[0].shape.outputs = 49; }, "outputs");
  refused([&](Description& d) { glossy(d)[0].shape.order = 7; }, "order");
  refused([&](Description& d) { glossy(d)[1].shape.full_channels = 0; }, "shadowedChannels");
  refused([&](Description& d) { glossy(d)[1].shape.order = 4; }, "differ in their orders");
  refused([&](Description& d) { glossy(d)[1].shape.outputs = 25; }, "differ in their outputs");
  refused([&](Description& d) { glossy(d).erase(glossy(d).begin()); },
          "the group's lights after the environment");
  refused([&](Description& d) { std::swap(glossy(d)[1], glossy(d)[2]); },
          "the group's lights after the environment");
  refused([&](Description& d) { glossy(d).push_back(glossy(d)[1]); },
          "the group's lights after the environment");
  refused([](Description& d) { std::swap(d.groups[0].cells[0].transfers, d.groups[0].cells[1].transfers); },
          "fewer outputs than the cell before");
  refused([](Description& d) { d.brdf_tables[0].payload = 0; }, "brdfTables[0].payload");
}

TEST_F(GlossyParts, TablesOfOtherBandsThanTheTransferAreRefused) {
  Sample sample = glossySample();
  const BrdfTable table{.order = 5, .lobes = 2, .angles = 2, .values = std::vector<float>(60, 0.1f)};
  const std::uint32_t payload = sample.description.brdf_tables[1].payload;
  const Blob bytes = encodeBrdfTable(table);
  sample.blobs[sample.description.payloads[payload].view] = bytes;
  sample.description.payloads[payload].raw_length = bytes.size();
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_TRUE(reader->readBrdfTable(0));
  const auto found = reader->readBrdfTable(1);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().problem.find("other bands"), std::string::npos) << found.error().line();
}

}  // namespace
}  // namespace lambent::bundle
