// A bundle with something of every kind that the loader brings, made in memory and written where a test wants
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/bundle/writer.hpp"

namespace lambent::streaming::testing {

// PNG (or JPEG) of texels made up from their place; channels 1, 3 or 4.
std::uint8_t texel(std::uint32_t x, std::uint32_t y, std::uint32_t channel);
std::vector<std::byte> pngFile(std::uint32_t width, std::uint32_t height, std::uint32_t channels);
std::vector<std::byte> jpegFile(std::uint32_t width, std::uint32_t height, std::uint8_t grey);

struct Sample {
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
};

// Two meshes (one of two primitives), three draws, two images, two groups of one and two cells, a table of
// b(v). Priorities are such that the order of the description is not the order of delivery.
Sample sampleBundle();
bundle::BrdfTable brdfTable();  // of that bundle

// `count` images, all of one view: side x side texels, little in the file and much in memory.
Sample manyImages(std::uint32_t count, std::uint32_t side);

// A folder of this test's own, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace lambent::streaming::testing
