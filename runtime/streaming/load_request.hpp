// The loader's work, item by item: what a bundle's description asks to be brought, in what order, and how one
// item is read, checked and decoded. Nothing here knows of threads. Errors name the bundle file and the item.
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
  std::uint32_t level = 0;  // the finest that is wanted
};
struct CodebookRequest {
  std::uint32_t group = 0, cell = 0, transfer = 0;
};
struct PlaneRequest {
  std::uint32_t group = 0, cell = 0, transfer = 0, plane = 0;
};
struct LightWeightsRequest {
  std::uint32_t group = 0, cell = 0;
};
struct ProxyRequest {
  std::uint32_t group = 0;
};
struct BrdfRequest {
  std::uint32_t table = 0;
};
struct DensityRequest {
  std::uint32_t group = 0;
};
struct VoxelsRequest {
  std::uint32_t group = 0;
};
using Work = std::variant<MeshRequest, WeightsRequest, ImageRequest, CodebookRequest, PlaneRequest,
                          LightWeightsRequest, ProxyRequest, BrdfRequest, DensityRequest, VoxelsRequest>;

// Meshes, then rows, then tables of BRDFs (without these three glossy surfaces do not show), then what
// volumes show by, then images, then light weights, proxies, codebooks and planes: each by the priority of
// its payload and, where that is equal, by place in the description. A codebook comes before its planes and
// those in their order, whatever priorities say.
std::vector<Work> requestsOf(const bundle::Description& description);

// What an item takes in the file.
std::uint64_t bytesInFile(const bundle::Description& description, const Work& work);

// Asked for the bytes that an item will hold, before they are held; false: give up.
using Reserve = std::function<bool(std::size_t)>;

// Empty if `reserve` said so.
std::optional<Result<Ready>> load(const bundle::Reader& reader, const Work& work, const Reserve& reserve);

// Memory that an item holds on to.
std::size_t bytesOf(const Ready& ready);

}  // namespace lambent::streaming
