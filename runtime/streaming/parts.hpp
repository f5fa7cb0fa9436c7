// Divides a bundle into parts that can be loaded one by one, with the GPU memory of each. The capture proxies
// of its groups come first; they replace the bundle if there is no memory for more. Next come its surfaces
// and volumes without shadows, with textures in a coarse level. For each rigid group the codebooks of its
// transfer and then its weight planes follow, a share at a time, and for each texture its finer levels, one
// by one. interest.hpp chooses among the parts by the camera.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/streaming/load_request.hpp"

namespace lambent::streaming {

// Lists items that are loaded and dropped together.
struct Step {
  std::vector<Work> work;
  std::uint64_t bytes = 0;
};

// Steps of a unit are loaded in order and dropped in reverse order.
using Unit = std::vector<Step>;

struct Parts {
  // The first unit has the proxies, in a separate step if there are any and memory is limited, and then
  // meshes, rows, textures and volumes. Next is a unit for the transfer of each group, and then one for the
  // finer levels of each image. Units may be empty, and those of images all are if memory is not limited.
  std::vector<Unit> units;
  struct Image {
    std::uint32_t width = 0, height = 0;
    std::uint32_t coarse = 0;           // finest level in the first unit
    std::vector<std::uint32_t> groups;  // groups that are drawn with the image
  };
  std::vector<Image> images;

  std::size_t firstImageUnit() const { return units.size() - images.size(); }
  bool isImage(std::size_t unit) const { return unit >= firstImageUnit(); }
  const Image& imageOf(std::size_t unit) const { return images[unit - firstImageUnit()]; }

  // Returns the number of steps of the first unit that show the surfaces. With fewer there is a proxy level
  // of detail or nothing.
  std::uint32_t surfaceSteps() const { return static_cast<std::uint32_t>(units.front().size()); }
  bool hasProxyLod() const { return surfaceSteps() > 1; }

  // Returns the number of planes of a transfer in the first `steps` steps of the group's unit.
  std::uint32_t planesIn(bundle::GroupIndex group, std::uint32_t steps, bundle::CellIndex cell,
                         bundle::TransferIndex transfer) const;
  // Returns the number of mip levels that an image has after the first `steps` steps of its unit.
  std::uint32_t levelsIn(std::size_t unit, std::uint32_t steps) const;

  // Returns the items of the given number of steps of each unit, in order. Of an image's levels it returns
  // only the finest, which includes the others.
  std::vector<Work> workOf(const std::vector<std::uint32_t>& steps) const;
};

// Divides a bundle into parts. If memory is `limited`, it reads the sizes of images and makes the proxies a
// separate step; else textures count as 0 bytes. Fails if an image cannot be read.
Result<Parts> partsOf(const bundle::Reader& reader, bool limited);

}  // namespace lambent::streaming
