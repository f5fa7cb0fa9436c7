// Declares the items that the loader produces: parts of a bundle that are read, checked and decoded, which
// residency.hpp puts on the GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/transfer/weights.hpp"

namespace lambent::streaming {

struct MeshChunk {
  std::uint32_t mesh = 0, primitive = 0;
  bundle::MeshData data;
  float mean_edge = 0.0f;  // mean length of the triangles' edges, in mesh space
};

// Holds an image from the finest level that is needed.
struct ImageChunk {
  std::uint32_t image = 0;
  std::uint32_t width = 0, height = 0;  // size of that level
  std::vector<std::uint8_t> rgba;       // row 0 is at the top; colours are sRGB-coded
  // The level as linear numbers, if the image serves as both and the averages of numbers differ from those of
  // colours; else empty.
  std::vector<std::uint8_t> linear{};
};

struct WeightsChunk {
  std::uint32_t draw = 0;
  transfer::VertexWeights rows;
};

struct CodebookChunk {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  bundle::TransferIndex transfer;
  transfer::Codebook codebook;
  std::vector<std::uint32_t> positions;  // sample of the cell | cluster << 16, in the order of the codes
};

struct PlaneChunk {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  bundle::TransferIndex transfer;
  bundle::PlaneIndex plane;
  std::vector<std::byte> codes;  // 8 or 16 bits per position, little endian, as the GPU reads them
};

struct LightWeightsChunk {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  std::vector<transfer::LightWeights> samples;
};

struct ProxyChunk {
  bundle::GroupIndex group;
  bundle::CaptureProxy proxy;
};

struct BrdfChunk {
  std::uint32_t table = 0;  // index into Description::brdf_tables
  bundle::BrdfTable data;
  BrdfTexels texels;
};

struct DensityChunk {
  bundle::GroupIndex group;
  std::vector<std::byte> codes;     // VolumeGrid::bits per voxel, little endian
  std::vector<float> block_maxima;  // volume_blocks.hpp
};

struct VoxelsChunk {
  bundle::GroupIndex group;
  std::vector<std::uint32_t> voxels;  // voxel of the transfer grid for each sample of the volume
};

using Ready = std::variant<MeshChunk, ImageChunk, WeightsChunk, CodebookChunk, PlaneChunk, LightWeightsChunk,
                           ProxyChunk, BrdfChunk, DensityChunk, VoxelsChunk>;

}  // namespace lambent::streaming
