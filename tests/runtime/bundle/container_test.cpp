// Tests the container: what is written is read back, and nothing damaged is accepted.
#include <cmath>
#include <cstddef>
#include <cstring>

#include <gtest/gtest.h>

#include "runtime/bundle/description_json.hpp"
#include "tests/runtime/bundle/sample_of_every_list.hpp"

namespace lambent::bundle {
namespace {

namespace fs = std::filesystem;

TEST_F(BundleFile, GivesBackWhatWasWritten) {
  const Sample sample = sampleOfEveryList();
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  const Description& d = reader->description();
  ASSERT_EQ(d.nodes.size(), 2u);
  EXPECT_EQ(d.nodes[0].name, sample.description.nodes[0].name);
  EXPECT_TRUE(d.nodes[0].movable);
  EXPECT_EQ(d.nodes[1].parent, 0);
  EXPECT_EQ(d.nodes[1].parent_from_node, sample.description.nodes[1].parent_from_node);
  EXPECT_EQ(d.materials[0].base_color, sample.description.materials[0].base_color);
  EXPECT_EQ(d.materials[0].alpha_mode, gltf::AlphaMode::Mask);
  EXPECT_EQ(d.materials[0].alpha_cutoff, 0.25f);
  EXPECT_EQ(d.materials[0].base_color_texture.texcoord, 1u);
  EXPECT_EQ(d.textures[0].sampler, sample.description.textures[0].sampler);
  EXPECT_EQ(d.cameras[0].yfov_rad, 0.7f);
  EXPECT_EQ(d.groups[0].rest_rotation, sample.description.groups[0].rest_rotation);
  EXPECT_EQ(d.generator.settings.at("rays"), "64");
  EXPECT_EQ(*reader->readView(0), sample.blobs[0]);
}

TEST_F(BundleFile, GivesBackClustersLampsAndNormalMappedCells) {
  const Sample sample = sampleOfEveryList();
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  const Group& group = reader->description().groups[0];
  ASSERT_EQ(group.lights.size(), 2u);
  EXPECT_EQ(group.lights[0].kind, GroupLight::Kind::Material);
  EXPECT_EQ(group.lights[0].spheres, sample.description.groups[0].lights[0].spheres);
  EXPECT_TRUE(group.lights[1].spheres.empty());
  EXPECT_EQ(group.lights[1].kind, GroupLight::Kind::Node);
  EXPECT_EQ(group.lights[1].index, 1u);
  EXPECT_EQ(group.lights[1].color, glm::vec3(0.0f, 40.0f, 0.5f));
  EXPECT_EQ(group.samplesOf(transfer::Form::Vector), 3u);
  EXPECT_EQ(group.cells[1].outputs(), 9u);
  const Cell& expected = sample.description.groups[0].cells[0];
  ASSERT_EQ(group.cells[0].transfers.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    const CellTransfer &found = group.cells[0].transfers[t], &wanted = expected.transfers[t];
    EXPECT_EQ(found.shape, wanted.shape);
    EXPECT_EQ(found.clusters, wanted.clusters);
    EXPECT_EQ(found.axes, wanted.axes);
    EXPECT_EQ(found.cluster_ids, wanted.cluster_ids);
    EXPECT_EQ(found.planes.size(), wanted.planes.size());
    EXPECT_EQ(found.error, wanted.error);
  }
  EXPECT_TRUE(group.cells[0].transfers[0].fromEnvironment());
  EXPECT_FALSE(group.cells[0].transfers[1].fromEnvironment());
  const auto codes = reader->readCodebook({}, {}, {});
  ASSERT_TRUE(codes) << codes.error().line();
  EXPECT_EQ(codes->codebook.axis_counts, (std::vector<std::uint32_t>{2, 0}));
  EXPECT_EQ(codes->codebook.axes[1].scale, 0.001f);
  EXPECT_EQ(codes->cluster_of, (std::vector<std::uint32_t>{0, 1, 0}));
  EXPECT_EQ(*reader->readPlane({}, {}, {}, {}), (std::vector<std::uint32_t>{65535, 7}));
  EXPECT_EQ(*reader->readPlane({}, {}, {}, PlaneIndex{1}), (std::vector<std::uint32_t>{3, 255}));
  EXPECT_EQ(reader->readCodebook({}, CellIndex{1}, {})->cluster_of, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_TRUE(reader->checkAll());
}

TEST_F(BundleFile, GivesBackLightProbesAndProxies) {
  Sample sample = sampleOfEveryList();
  sample.description.groups.emplace_back().name = "bare";  // no cells, no proxy
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  const Group &group = reader->description().groups[0], &wanted = sample.description.groups[0];
  EXPECT_EQ(group.light_probes, wanted.light_probes);
  EXPECT_EQ(group.cells[0].light_probes, wanted.cells[0].light_probes);
  EXPECT_EQ(group.cells[1].light_probes, wanted.cells[1].light_probes);
  EXPECT_EQ(*reader->readLightWeights({}, {}), kWeights);
  EXPECT_EQ(*reader->readLightWeights({}, CellIndex{1}),
            (std::vector<transfer::LightWeights>(2, transfer::kOneLight)));
  const auto proxy = reader->readProxy({});
  ASSERT_TRUE(proxy) << proxy.error().line();
  ASSERT_EQ(proxy->entries.size(), 1u);
  EXPECT_EQ(proxy->entries[0].sample, 4u);
  EXPECT_EQ(proxy->triangles[0].light, 1);
  EXPECT_EQ(reader->description().groups[1].light_probes.size(), 1u);
  EXPECT_TRUE(reader->readProxy(GroupIndex{1})->levels.empty());
  EXPECT_TRUE(reader->checkAll());
}

TEST_F(BundleFile, IsNotWrittenOfTransferThatIsNotANumber) {
  for (const bool of_plane : {false, true}) {
    Sample sample = sampleOfEveryList();
    CellTransfer& transfer = sample.description.groups[0].cells[0].transfers[0];
    (of_plane ? transfer.planes.at(0).variance : transfer.error) = std::nanf("");
    const auto written = write(path_, sample.description, sample.blobs);
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().line().find("not a number"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
}

TEST_F(BundleFile, TruncatedAtAnyPrefixIsRefusedInOneLine) {
  const Sample sample = sampleOfEveryList();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string whole = bytes();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    replace(whole.substr(0, length));
    const auto read = readAll();
    ASSERT_FALSE(read) << "prefix of " << length << " bytes";
    EXPECT_EQ(read.error().subject.rfind(path_.string(), 0), 0u) << read.error().line();
    EXPECT_EQ(read.error().line().find('\n'), std::string::npos);
  }
  replace(whole + "x");
  EXPECT_FALSE(readAll());
}

TEST_F(BundleFile, AnyFlippedByteIsRefused) {
  const Sample sample = sampleOfEveryList();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    replace(damaged);
    const auto read = readAll();
    ASSERT_FALSE(read) << "byte " << at << " of " << whole.size();
    EXPECT_FALSE(read.error().hint.empty());
  }
}

// Bakers and copies write while a world reads.
TEST_F(BundleFile, ReplacedWhileItIsReadGivesTheOldBytesOrAnError) {
  const Sample sample = sampleOfEveryList();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const auto bytes = std::filesystem::file_size(path_);
  const auto reader = Reader::open(path_);
  ASSERT_TRUE(reader);
  ASSERT_TRUE(reader->checkAll());
  // A bake renames its bundle into place, and the reader keeps what it has opened.
  std::ofstream(folder_ / "other") << "another bundle";
  fs::rename(folder_ / "other", path_);
  EXPECT_TRUE(reader->checkAll());
  // A copy writes into the file itself.
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const auto copied_over = Reader::open(path_);
  ASSERT_TRUE(copied_over);
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary) << std::string(bytes, 'x');
  const auto damaged = copied_over->checkAll();
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().problem.find("is damaged: byte range 0"), std::string::npos)
      << damaged.error().problem;
  std::filesystem::resize_file(path_, bytes / 8);
  const auto cut = copied_over->checkAll();
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().problem, "is truncated");
}

TEST_F(BundleFile, TooNewIsCalledTooNew) {
  Sample sample = sampleOfEveryList();
  sample.description.version = kVersionCurrent + 1;
  refused(sample, "newer than this program's");
}

TEST_F(BundleFile, AnOlderVersionIsToBeBakedAgain) {
  for (const std::uint32_t version : {kVersionFirstLight, kVersionClusteredTransfer}) {
    Sample sample = sampleOfEveryList();
    sample.description.version = version;
    refused(sample, "was written by an older program");
    EXPECT_EQ(Reader::open(path_).error().hint, "bake it again");
  }
}

TEST_F(BundleFile, WhatACheckRefusesDoesNotTakeThePlaceOfTheOldOne) {
  Sample sample = sampleOfEveryList();
  ASSERT_TRUE(write(path_, sample.description, sample.blobs));
  const std::string before = bytes();
  sample.description.roots = {99};
  const auto written = write(path_, sample.description, sample.blobs, [&](const std::filesystem::path& part) {
    EXPECT_NE(part, path_);
    const auto reader = Reader::open(part);
    return reader ? Result<void>() : failAgain(reader.error());
  });
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().subject, path_);
  EXPECT_NE(written.error().problem.find("scenes[0].nodes[0]"), std::string::npos) << written.error().line();
  EXPECT_TRUE(bytes() == before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

// Surrounds nonsense with valid checksums, as a hostile or buggy writer could.
TEST_F(BundleFile, IndicesOutOfRangeAreRefusedByName) {
  const auto refused = [&](auto spoil, const char* place) {
    Sample sample = sampleOfEveryList();
    spoil(sample.description);
    BundleFile::refused(sample, place);
  };
  refused([](Description& d) { d.roots = {2}; }, "scenes[0].nodes[0]");
  refused([](Description& d) { d.nodes[1].children = {0}; }, "nodes form a ring");
  refused([](Description& d) { d.images[0].view = 99; }, "images[0].bufferView");
  refused([](Description& d) { d.textures[0].image = 1; }, "textures[0].source");
  refused([](Description& d) { d.groups[0].cells[1].sample_count = 3; }, "sampleCount");
  refused([](Description& d) { d.groups[0].sample_count = 6; }, "do not hold all samples");
  const auto first = [](Description& d) -> CellTransfer& { return d.groups[0].cells[0].transfers[0]; };
  const auto lamps = [](Description& d) -> CellTransfer& { return d.groups[0].cells[0].transfers[1]; };
  refused([&](Description& d) { first(d).shape.order = 9; }, "order");
  refused([&](Description& d) { first(d).shape.order = 0; }, "order");
  refused([&](Description& d) { first(d).shape.light_columns = 2; }, "order");
  refused([&](Description& d) { first(d).shape.full_channels = 2; }, "fullChannels");
  refused([&](Description& d) { first(d).shape.shadowed_channels = 0; }, "shadowedChannels");
  refused([&](Description& d) { first(d).shape.outputs = 3; }, "outputs");
  refused([&](Description& d) { first(d).clusters = 0; }, "clusters");
  refused([&](Description& d) { first(d).axes = 5; }, "axes");
  refused([&](Description& d) { first(d).cluster_ids = 0; }, "clusterIds is a payload of another type");
  refused([&](Description& d) { first(d).cluster_ids = -1; }, "clusterIds is missing");
  refused([&](Description& d) { first(d).planes[0].payload = 0; }, "another type");
  refused([&](Description& d) { first(d).planes[0].count = 1; }, "another size");
  refused([&](Description& d) { first(d).planes[1].count = 3; }, "planes[1].count");
  refused([&](Description& d) { lamps(d).shape.light_columns = 1; }, "lightColumns");
  refused(
      [](Description& d) { std::swap(d.groups[0].cells[0].transfers[0], d.groups[0].cells[0].transfers[1]); },
      "the group's lights after the environment");
  refused([](Description& d) { d.groups[0].cells[0].transfers.push_back(d.groups[0].cells[0].transfers[1]); },
          "the group's lights after the environment");
  refused([](Description& d) { d.groups[0].lights[0].index = 1; }, "lights[0].material");
  refused([](Description& d) { d.groups[0].lights[0].spheres[1].radius_m = 0.0f; }, "spheres[1].radius");
  refused([](Description& d) { d.groups[0].lights[0].spheres[0].body_radius_m = 0.2f; }, "bodyRadius");
  refused([](Description& d) { d.groups[0].lights[0].spheres.resize(5, {{}, 1.0f, 1.0f}); }, "too many");
  refused([](Description& d) { d.groups[0].lights[1].spheres = {{{}, 1.0f, 1.0f}}; }, "those of a node");
  refused([](Description& d) { d.groups[0].lights[1].index = 2; }, "lights[1].node");
  refused([](Description& d) { d.groups[0].lights[1].index = 0; }, "carries no light");
  refused(
      [](Description& d) {
        Group& g = d.groups[0];
        std::swap(g.cells[0], g.cells[1]);
        g.cells[0].first_sample = 0;
        g.cells[1].first_sample = 2;
      },
      "fewer outputs than the cell before");
  const auto cell = [](Description& d) -> Cell& { return d.groups[0].cells[0]; };
  refused([](Description& d) { d.groups[0].light_probes.clear(); }, "lightSamples are none");
  refused([](Description& d) { d.groups[0].light_probes.pop_back(); }, "cells[0].lightSamples[2]");
  refused([](Description& d) { d.groups[0].light_probes.emplace_back(0.0f); }, "not all taken by a cell");
  refused([&](Description& d) { cell(d).light_probes = {}; }, "are not 1 to 64");
  refused([&](Description& d) { cell(d).light_probes = {0, 2, 1}; }, "lightSamples[2] does not rise");
  refused([&](Description& d) { cell(d).light_probes = {0, 1, 1}; }, "lightSamples[2] does not rise");
  refused(
      [&](Description& d) {
        d.groups[0].light_probes.resize(65);
        for (std::uint32_t i = 3; i < 65; ++i) cell(d).light_probes.push_back(i);
      },
      "are not 1 to 64");
  refused([&](Description& d) { cell(d).light_probes = {1}; }, "lightWeights are there for one");
  refused([&](Description& d) { cell(d).light_weights = -1; }, "lightWeights is missing");
  refused([&](Description& d) { cell(d).light_weights = 0; }, "lightWeights is a payload of another type");
  refused(
      [&](Description& d) {
        d.groups[0].cells[1].light_probes = {0, 1};
        d.groups[0].cells[1].light_weights = cell(d).light_weights;
      },
      "lightWeights is a payload of another size");
  refused([](Description& d) { d.groups[0].proxy = 0; }, "proxy is a payload of another type");
  refused([](Description& d) { d.groups[0].proxy = 99; }, "proxy is 99");
  refused([](Description& d) { d.payloads[0].raw_length = 17; }, "rawLength");
  refused([](Description& d) { d.groups[0].rest_rotation = glm::quat(0.0f, 0.0f, 0.0f, 0.0f); },
          "restRotation");
}

TEST_F(BundleFile, ClustersThatContradictThePlanesAreRefusedBeforeUse) {
  Sample sample = sampleOfEveryList();
  const auto ids = static_cast<std::uint32_t>(sample.description.groups[0].cells[0].transfers[0].cluster_ids);
  sample.blobs[sample.description.payloads[ids].view] =
      transfer::encodeClusterIds(std::vector{0u, 0u, 0u}, 2);
  const auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  const auto codes = reader->readCodebook({}, {}, {});
  ASSERT_FALSE(codes);
  EXPECT_NE(codes.error().line().find("group 0 cell 0: has weight planes of other sizes"), std::string::npos)
      << codes.error().line();
  EXPECT_FALSE(reader->checkAll());
}

TEST_F(BundleFile, CodebooksOfAnotherSizeThanDescribedAreRefusedBeforeUse) {
  const auto refused = [&](auto spoil) {
    Sample sample = sampleOfEveryList();
    spoil(sample.description.groups[0].cells[0].transfers[0]);
    const auto reader = through(sample);
    ASSERT_TRUE(reader) << reader.error().line();
    const auto codes = reader->readCodebook({}, {}, {});
    ASSERT_FALSE(codes);
    EXPECT_NE(codes.error().line().find("group 0 cell 0: has a"), std::string::npos) << codes.error().line();
  };
  refused([](CellTransfer& transfer) { transfer.shape.full_channels = 0; });
  refused([](CellTransfer& transfer) { transfer.clusters = 3; });
  refused([](CellTransfer& transfer) { transfer.axes = 3; });
  refused([](CellTransfer& transfer) { transfer.axes = 0; });
}

TEST_F(BundleFile, StandsInTheWorldToAllDigitsAndCountsFromAnyOrigin) {
  Sample sample = sampleOfEveryList();
  Description& d = sample.description;
  d.origin = {5e6, 1024.0, -0.5};
  const glm::vec4 place = d.nodes[0].parent_from_node[3];
  const glm::vec3 rest = d.groups[0].rest_translation;
  auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  EXPECT_EQ(reader->description().origin, d.origin);
  EXPECT_EQ(reader->description().nodes[0].parent_from_node[3], place);
  EXPECT_EQ(reader->description().nodes[1].parent_from_node, d.nodes[1].parent_from_node);
  EXPECT_EQ(reader->description().groups[0].rest_translation, rest);
  EXPECT_TRUE(reader->checkAll());
  reader->countFrom({5e6 - 8.0, 1024.0, 0.0});
  EXPECT_EQ(reader->description().nodes[0].parent_from_node[3], place + glm::vec4(8.0f, 0.0f, -0.5f, 0.0f));
  EXPECT_EQ(reader->description().groups[0].rest_translation, rest + glm::vec3(8.0f, 0.0f, -0.5f));
}

TEST_F(BundleFile, WithoutAnOriginCountsFromAnotherBelowANodeOfItsOwn) {
  const Sample sample = sampleOfEveryList();
  auto reader = through(sample);
  ASSERT_TRUE(reader) << reader.error().line();
  reader->countFrom({-2.0, 0.0, 0.0});
  const Description& d = reader->description();
  ASSERT_EQ(d.nodes.size(), sample.description.nodes.size() + 1);
  EXPECT_EQ(d.nodes[0].parent_from_node, sample.description.nodes[0].parent_from_node);
  EXPECT_EQ(gltf::worldTransforms(d.nodes)[0][3],
            sample.description.nodes[0].parent_from_node[3] + glm::vec4(2.0f, 0.0f, 0.0f, 0.0f));
  EXPECT_EQ(d.roots, std::vector<std::int32_t>{static_cast<std::int32_t>(d.nodes.size()) - 1});
}

}  // namespace
}  // namespace lambent::bundle
