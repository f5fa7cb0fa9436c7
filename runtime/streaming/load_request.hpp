// Defines the items that the loader loads and their order, and reads, checks and decodes one item. It uses no
// threads. Errors name the bundle file and the item.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/loaded_chunk.hpp"

namespace lambent::streaming {

struct MeshRequest {
  std::uint32_t mesh = 0, primitive = 0;
};
struct WeightsRequest {
  std::uint32_t draw = 0;
};
struct ImageRequest {
  std::uint32_t image = 0;
  std::uint32_t level = 0;  // finest mip level that is needed
};
struct CodebookRequest {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  bundle::TransferIndex transfer;
};
struct PlaneRequest {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
  bundle::TransferIndex transfer;
  bundle::PlaneIndex plane;
};
struct LightWeightsRequest {
  bundle::GroupIndex group;
  bundle::CellIndex cell;
};
struct ProxyRequest {
  bundle::GroupIndex group;
};
struct BrdfRequest {
  std::uint32_t table = 0;
};
struct DensityRequest {
  bundle::GroupIndex group;
};
struct VoxelsRequest {
  bundle::GroupIndex group;
};
using Work = std::variant<MeshRequest, WeightsRequest, ImageRequest, CodebookRequest, PlaneRequest,
                          LightWeightsRequest, ProxyRequest, BrdfRequest, DensityRequest, VoxelsRequest>;

// Returns all items of a bundle in the order of loading: meshes, rows, BRDF tables (glossy surfaces need
// these three), grids of volumes, images, and then light weights, proxies, codebooks and planes. Items of a
// kind are sorted by the priority of their payload and then by their order in the description. A codebook
// always comes before its planes, which keep their order.
std::vector<Work> requestsOf(const bundle::Description& description);

// Returns the size of an item in the file.
std::uint64_t bytesInFile(const bundle::Description& description, const Work& work);

// Reserves the bytes that an item will need in memory. Returns false if the item is not wanted any more.
using Reserve = std::function<bool(std::size_t)>;

// Loads an item. Returns nothing if `reserve` returned false.
std::optional<Result<Ready>> load(const bundle::Reader& reader, const Work& work, const Reserve& reserve);

// Returns the memory that a loaded item uses.
std::size_t bytesOf(const Ready& ready);

}  // namespace lambent::streaming
