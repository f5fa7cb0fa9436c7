// Makes a bundle in memory with something of every kind that the loader delivers, and writes it where a test
// wants it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::streaming::testing {

// Encodes synthetic texels as PNG (or JPEG) with 1, 3 or 4 channels.
std::uint8_t texel(std::uint32_t x, std::uint32_t y, std::uint32_t channel);
std::vector<std::byte> pngFile(std::uint32_t width, std::uint32_t height, std::uint32_t channels);
std::vector<std::byte> jpegFile(std::uint32_t width, std::uint32_t height, std::uint8_t grey);

struct Sample {
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
};

// Makes two meshes (one of two primitives), three draws, two images, two groups of one and two cells, and a
// table of b(v). The priorities differ from the order of the description.
Sample sampleBundle();
bundle::BrdfTable brdfTable();  // the table of sampleBundle()

// Makes a bundle of `count` images that share one view: side x side texels, small in the file and large in
// memory.
Sample manyImages(std::uint32_t count, std::uint32_t side);

}  // namespace lambent::streaming::testing
