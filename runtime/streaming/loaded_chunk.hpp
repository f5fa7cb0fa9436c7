// What the loader hands on, item by item: parts of a bundle, read, checked and decoded, as residency.hpp puts
// them on the GPU. Types only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/light_weights.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/brdf_texture.hpp"

namespace lambent::streaming {

struct MeshChunk {
  std::uint32_t mesh = 0, primitive = 0;
  bundle::MeshData data;
  float mean_edge = 0.0f;  // length of the triangles' edges, mesh space
};

// The image from one of its levels on, the finest that is wanted.
struct ImageChunk {
  std::uint32_t image = 0;
  std::uint32_t width = 0, height = 0;  // of that level
  std::vector<std::uint8_t> rgba;       // row 0 at the top; colour sRGB-coded
  // Means of numbers, where those of colours are others and the image serves as both; else empty.
  std::vector<std::uint8_t> linear{};
};

struct WeightsChunk {
  std::uint32_t draw = 0;
  bundle::VertexWeights rows;
};

struct CodebookChunk {
  std::uint32_t group = 0, cell = 0, transfer = 0;  // transfer: index into Cell::diffuse
  bundle::Codebook codebook;
  std::vector<std::uint32_t> positions;  // in the order of the codes: sample of the cell | cluster << 16
};

struct PlaneChunk {
  std::uint32_t group = 0, cell = 0, transfer = 0, plane = 0;
  std::vector<std::byte> codes;  // as the GPU reads them: bits per position, little endian
};

struct LightWeightsChunk {
  std::uint32_t group = 0, cell = 0;
  std::vector<bundle::LightWeights> samples;
};

struct ProxyChunk {
  std::uint32_t group = 0;
  bundle::CaptureProxy proxy;
};

struct BrdfChunk {
  std::uint32_t table = 0;  // of Description::brdf_tables
  bundle::BrdfTable data;
  BrdfTexels texels;
};

struct DensityChunk {
  std::uint32_t group = 0;
  std::vector<std::byte> codes;     // of all voxels, VolumeGrid::bits each, little endian
  std::vector<float> block_maxima;  // volume_blocks.hpp
};

struct VoxelsChunk {
  std::uint32_t group = 0;
  std::vector<std::uint32_t> voxels;  // of the transfer grid, one per sample of the volume
};

using Ready = std::variant<MeshChunk, ImageChunk, WeightsChunk, CodebookChunk, PlaneChunk, LightWeightsChunk,
                           ProxyChunk, BrdfChunk, DensityChunk, VoxelsChunk>;

}  // namespace lambent::streaming
