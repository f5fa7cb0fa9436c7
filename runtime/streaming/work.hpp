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
#include "runtime/streaming/ready.hpp"

namespace lambent::streaming {

struct MeshWork {
  std::uint32_t mesh = 0, primitive = 0;
};
struct RowsWork {
  std::uint32_t draw = 0;
};
struct ImageWork {
  std::uint32_t image = 0;
  std::uint32_t level = 0;  // the finest that is wanted
};
struct CodebookWork {
  std::uint32_t group = 0, cell = 0, transfer = 0;
};
struct PlaneWork {
  std::uint32_t group = 0, cell = 0, transfer = 0, plane = 0;
};
struct LightWeightsWork {
  std::uint32_t group = 0, cell = 0;
};
struct ProxyWork {
  std::uint32_t group = 0;
};
struct BrdfWork {
  std::uint32_t table = 0;
};
struct DensityWork {
  std::uint32_t group = 0;
};
struct VoxelsWork {
  std::uint32_t group = 0;
};
using Work = std::variant<MeshWork, RowsWork, ImageWork, CodebookWork, PlaneWork, LightWeightsWork, ProxyWork,
                          BrdfWork, DensityWork, VoxelsWork>;

// Meshes, then rows, then tables of BRDFs (without these three glossy surfaces do not show), then what
// volumes show by, then images, then light weights, proxies, codebooks and planes: each by the priority of
// its payload and, where that is equal, by place in the description. A codebook comes before its planes and
// those in their order, whatever priorities say.
std::vector<Work> workList(const bundle::Description& description);

// What an item takes in the file.
std::uint64_t bytesInFile(const bundle::Description& description, const Work& work);

// Asked for the bytes that an item will hold, before they are held; false: give up.
using Reserve = std::function<bool(std::size_t)>;

// Empty if `reserve` said so.
std::optional<Result<Ready>> load(const bundle::Reader& reader, const Work& work, const Reserve& reserve);

// Memory that an item holds on to.
std::size_t bytesOf(const Ready& ready);

}  // namespace lambent::streaming
