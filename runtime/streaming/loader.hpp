// Loads a bundle into memory on worker threads. They read byte ranges, check them, and decode Draco, images
// and entropy coding, without GL. The render thread takes loaded items and uploads them within its budget
// (residency.hpp). Items are delivered in the order of their priority, whatever the number of threads.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/base/threads.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/mesh.hpp"
#include "runtime/streaming/textures.hpp"
#include "runtime/transfer/codebook.hpp"

namespace lambent::streaming {

// A request names an item of a bundle. Its chunk is the item as the loader produces it: read, checked and
// decoded, for residency.hpp to put on the GPU. Errors name the bundle file and the item.
struct MeshRequest {
  std::uint32_t mesh = 0, primitive = 0;
};
struct MeshChunk : MeshRequest {
  bundle::MeshData data;
  float mean_edge = 0.0f;  // mean length of the triangles' edges, in mesh space
};

struct ImageRequest {
  std::uint32_t image = 0;
  std::uint32_t level = 0;  // finest mip level that is needed
};
struct ImageChunk : ImageRequest {
  std::uint32_t width = 0, height = 0;  // size of that level
  std::vector<std::uint8_t> rgba;       // row 0 is at the top; colours are sRGB-coded
  // The level as linear numbers, if the image serves as both and the averages of numbers differ from those of
  // colours; else empty.
  std::vector<std::uint8_t> linear{};
};

struct WeightsRequest {
  std::uint32_t draw = 0;
};
struct WeightsChunk : WeightsRequest {
  transfer::VertexWeights rows;
};

struct CodebookRequest {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  bundle::TransferIndex transfer;
};
struct CodebookChunk : CodebookRequest {
  transfer::Codebook codebook;
  std::vector<std::uint32_t> positions;  // sample of the cell | cluster << 16, in the order of the codes
};

struct PlaneRequest : CodebookRequest {
  bundle::PlaneIndex plane;
};
struct PlaneChunk : PlaneRequest {
  std::vector<std::byte> codes;  // 8 or 16 bits per position, little endian, as the GPU reads them
};

struct LightWeightsRequest {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
};
struct LightWeightsChunk : LightWeightsRequest {
  std::vector<transfer::LightWeights> samples;
};

struct ProxyRequest {
  bundle::GroupIndex group;
};
struct ProxyChunk : ProxyRequest {
  bundle::CaptureProxy proxy;
};

struct BrdfRequest {
  std::uint32_t table = 0;  // index into Description::brdf_tables
};
struct BrdfChunk : BrdfRequest {
  bundle::BrdfTable data;
  BrdfTexels texels;
};

struct DensityRequest {
  bundle::GroupIndex group;
};
struct DensityChunk : DensityRequest {
  std::vector<std::byte> codes;     // VolumeGrid::bits per voxel, little endian
  std::vector<float> block_maxima;  // see blockMaxima()
};

struct VoxelsRequest {
  bundle::GroupIndex group;
};
struct VoxelsChunk : VoxelsRequest {
  std::vector<std::uint32_t> voxels;  // voxel of the transfer grid for each sample of the volume
};

using Work = std::variant<MeshRequest, WeightsRequest, ImageRequest, CodebookRequest, PlaneRequest,
                          LightWeightsRequest, ProxyRequest, BrdfRequest, DensityRequest, VoxelsRequest>;
using Ready = std::variant<MeshChunk, ImageChunk, WeightsChunk, CodebookChunk, PlaneChunk, LightWeightsChunk,
                           ProxyChunk, BrdfChunk, DensityChunk, VoxelsChunk>;

// Returns all items of a bundle in the order of loading: meshes, rows, BRDF tables (glossy surfaces need
// these three), grids of volumes, images, and then light weights, proxies, codebooks and planes. Items of a
// kind are sorted by the priority of their payload and then by their order in the description. A codebook
// always comes before its planes, which keep their order.
std::vector<Work> requestsOf(const bundle::Description& description);

// Returns the memory that a loaded item uses, which is about what its upload takes.
std::size_t bytesOf(const Ready& ready);

// Computes the largest density in blocks of 8 x 8 x 8 voxels, so that rays can skip empty blocks. The density
// is linear between voxel centres, so the maximum of a block includes the voxels next to it.
inline constexpr std::uint32_t kVolumeBlock = 8;  // voxels per side

// Returns the number of blocks along each axis. Block b fills [8 b, 8 b + 8] in voxel coordinates.
inline glm::uvec3 blocksOf(const glm::uvec3& size) {
  return (size + glm::uvec3(kVolumeBlock - 1)) / kVolumeBlock;
}

// Returns the maxima as fractions of the largest code of `bits` (8 or 16), x fastest. `codes` are those of
// bundle::VolumeGrid.
std::vector<float> blockMaxima(std::span<const std::byte> codes, std::uint32_t bits, const glm::uvec3& size);

// Workers claim items in order and put the loaded item into its slot; take() empties slots from the front. So
// items keep the order of the list, however many workers there are and however long each item takes.
class Loader {
 public:
  // Starts `workers` (at least 1) that load the whole bundle in the order of requestsOf(). The loader must be
  // destroyed before `threads`.
  Loader(std::shared_ptr<const bundle::Reader> reader, ThreadPool& threads, unsigned workers);
  // Loads only these items, in this order.
  Loader(std::shared_ptr<const bundle::Reader> reader, std::vector<Work> work, ThreadPool& threads,
         unsigned workers);
  ~Loader();  // waits until the workers have finished their current items
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  // Returns loaded items in order, up to about max_bytes, but at least one if any is ready. Never waits.
  std::vector<Ready> take(std::size_t max_bytes);
  // Waits until an item is ready or no more will come, or for this long.
  void waitForMore(std::chrono::milliseconds most = std::chrono::hours(1));
  // Returns true once every item has been taken, or loading has stopped at an error.
  bool finished() const;
  // Returns the first error, at which loading stops.
  std::optional<Error> error() const;

  // Stops loading. Workers end after their current items.
  void stop();
  // Returns whether all workers have ended, so that the destructor does not wait.
  bool idle() const;

 private:
  struct Slot {
    std::optional<Ready> ready;
    std::size_t held = 0;  // bytes that are reserved, and later those of `ready`
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  void runWorker();
  std::optional<Result<Ready>> loadOne(std::size_t at);
  // Waits for memory. Returns false if the item is not wanted any more.
  bool reserve(std::size_t at, std::size_t bytes);

  // The caller of these holds the mutex.
  void hold(std::size_t at, std::size_t bytes);
  std::size_t end() const { return std::min(work_.size(), failed_at_); }
  bool frontIsReady() const { return next_take_ < end() && slots_[next_take_].ready.has_value(); }

  const std::shared_ptr<const bundle::Reader> reader_;
  const std::vector<Work> work_;

  mutable std::mutex mutex_;      // guards the members below
  std::condition_variable more_;  // signals that an item is ready or no more will come
  std::condition_variable room_;  // signals that an item was taken or is not wanted any more
  std::vector<Slot> slots_;       // one per item of the work
  std::size_t next_claim_ = 0;
  std::size_t next_take_ = 0;
  std::size_t held_bytes_ = 0;
  std::size_t failed_at_ = kNone;
  Error failure_;
  bool stopping_ = false;
  std::size_t working_ = 0;        // number of workers that have not ended
  std::condition_variable ended_;  // signals that a worker has ended
};

}  // namespace lambent::streaming
