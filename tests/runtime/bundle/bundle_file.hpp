// Builds bundles, and provides a folder for the file that vanishes with the test.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/bundle/container.hpp"

namespace lambent::bundle {

// Holds a description and the bytes that it refers to.
struct Sample {
  Description description;
  std::vector<Blob> blobs;

  // Adds the next payload, whose priority is its index.
  std::uint32_t add(PayloadType type, const Blob& bytes) {
    const bool zstd = type == PayloadType::WeightPlane;
    blobs.push_back(zstd ? compressZstd(bytes, 3) : bytes);
    std::vector<Payload>& payloads = description.payloads;
    payloads.push_back({type, zstd ? PayloadCodec::Zstd : PayloadCodec::Raw,
                        static_cast<std::uint32_t>(blobs.size() - 1), bytes.size(),
                        static_cast<std::uint32_t>(payloads.size())});
    return static_cast<std::uint32_t>(payloads.size() - 1);
  }
  // Adds a transfer of this shape whose codebook has one cluster without axes.
  CellTransfer meanTransfer(const transfer::TransferShape& shape) {
    CellTransfer made;
    made.shape = shape;
    const transfer::Codebook book{{0}, {}, std::vector<float>(shape.size(), 0.25f)};
    made.codebook = add(PayloadType::Codebook, transfer::encodeCodebook(book));
    return made;
  }
};

class BundleFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("lambent-bundle-test-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    path_ = folder_ / "scene.lmb.glb";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string bytes() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void replace(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  // Reads everything that the demo would read.
  Result<void> readAll() const {
    auto reader = Reader::open(path_);
    if (!reader) return failAgain(reader.error());
    return reader->checkAll();
  }

  Result<Reader> through(const Sample& sample) const {
    if (auto written = write(path_, sample.description, sample.blobs); !written)
      return failAgain(written.error());
    return Reader::open(path_);
  }
  // Expects that the sample cannot be read, and that the error names the place.
  void refused(const Sample& sample, const char* place) const {
    const auto reader = through(sample);
    ASSERT_FALSE(reader) << place;
    EXPECT_NE(reader.error().problem.find(place), std::string::npos) << reader.error().line();
  }

  std::filesystem::path folder_, path_;
};

}  // namespace lambent::bundle
