// Brings a bundle into memory in the order in which it is wanted, on worker threads: reads ranges, checks
// them, decodes Draco, images and entropy coding. No GL: the render thread takes what is ready and uploads it
// within its budget (residency.hpp). Order of delivery is the order of priority, whatever the number of
// threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/light_weights.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/brdf_texture.hpp"

namespace lambent::streaming {

struct MeshReady {
  std::uint32_t mesh = 0, primitive = 0;
  bundle::MeshData data;
};

struct ImageReady {
  std::uint32_t image = 0;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // row 0 at the top; colour sRGB-coded
};

struct RowsReady {
  std::uint32_t draw = 0;
  bundle::VertexRows rows;
};

struct CodebookReady {
  std::uint32_t group = 0, cell = 0, transfer = 0;  // transfer: index into Cell::diffuse
  bundle::Codebook codebook;
  std::vector<std::uint32_t> positions;  // in the order of the codes: sample of the cell | cluster << 16
};

struct PlaneReady {
  std::uint32_t group = 0, cell = 0, transfer = 0, plane = 0;
  std::vector<std::byte> codes;  // as the GPU reads them: bits per position, little endian
};

struct LightWeightsReady {
  std::uint32_t group = 0, cell = 0;
  std::vector<bundle::LightWeights> samples;
};

struct ProxyReady {
  std::uint32_t group = 0;
  bundle::CaptureProxy proxy;
};

struct BrdfReady {
  std::uint32_t table = 0;  // of Description::brdf_tables
  bundle::BrdfTable data;
  BrdfTexels texels;
};

struct DensityReady {
  std::uint32_t group = 0;
  std::vector<std::byte> codes;     // of all voxels, VolumeGrid::bits each, little endian
  std::vector<float> block_maxima;  // volume_blocks.hpp
};

struct VoxelsReady {
  std::uint32_t group = 0;
  std::vector<std::uint32_t> voxels;  // of the transfer grid, one per sample of the volume
};

using Ready = std::variant<MeshReady, ImageReady, RowsReady, CodebookReady, PlaneReady, LightWeightsReady,
                           ProxyReady, BrdfReady, DensityReady, VoxelsReady>;

class Loader {
 public:
  // Starts `threads` workers (at least 1) on everything in the bundle: meshes and rows first, then
  // tables of BRDFs, grids of volumes, images, then codebooks and planes by priority.
  Loader(std::shared_ptr<const bundle::Reader> reader, unsigned threads);
  // Brings only what `wanted` still lists: the bundle's description with weight planes cut off (budget.hpp).
  Loader(std::shared_ptr<const bundle::Reader> reader, bundle::Description wanted, unsigned threads);
  ~Loader();  // stops the workers after the item in hand
  Loader(Loader&&) noexcept;
  Loader& operator=(Loader&&) noexcept;

  // What is ready, in order, up to about max_bytes (at least one item if any is ready). Never waits.
  std::vector<Ready> take(std::size_t max_bytes);
  // Waits until something is ready or nothing more will come.
  void waitForMore();
  // True once every item has been taken, or loading stopped at an error.
  bool finished() const;
  // The first error; loading stops there.
  std::optional<Error> error() const;

  std::uint64_t bytesRead() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lambent::streaming
