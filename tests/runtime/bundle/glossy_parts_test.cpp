// Tests that the glossy parts of a bundle are read back as they were written, and that contradictions are
// refused by name.
#include <gtest/gtest.h>

#include "tests/runtime/bundle/bundle_file.hpp"

namespace lambent::bundle {
namespace {

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
