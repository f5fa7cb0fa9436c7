// Divides a bundle into parts that can be loaded one by one, with the GPU memory of each. The capture proxies
// of its groups come first; they replace the bundle if there is no memory for more. Next come its surfaces
// and volumes without shadows, with textures in a coarse level. For each rigid group the codebooks of its
// transfer and then its weight planes follow, a share at a time, and for each texture its finer levels, one
// by one. choose() chooses among the parts by the camera.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/streaming/loader.hpp"

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
  // Returns whether this step brings the proxy level of detail.
  bool isProxyLod(std::uint32_t unit, std::uint32_t step) const {
    return unit == 0 && step + 1 < surfaceSteps();
  }

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

// Chooses what to keep on the GPU if the bundles need more memory than there is. The choice depends on each
// bundle's parts, on how large the camera sees it and its groups, and on the previous choice. The result is a
// number of steps per unit. The same camera path gives the same choices, however fast loading is. A choice
// stays until something else is clearly worth more, so that nothing is loaded and dropped again and again.
// Nothing here uses GL or threads.
struct Interest {
  Parts parts;
  std::vector<float> size;  // sizeSeen() of each unit; the first unit has the largest of all
  // Steps of each unit that should be here: the previous choice on input, the new one on output.
  std::vector<std::uint32_t> target;
};

// Returns about the share of the view that a sphere covers: the square of radius over distance. It is reduced
// if the sphere is out of sight.
float sizeSeen(const spec::View& view, const glm::vec3& center_ws, float radius_m);

// Returns the value of a step of a unit that is seen with this size. It falls from step to step.
float worthOf(const Parts& parts, std::uint32_t unit, std::uint32_t step, float size);

// Chooses steps that need at most `max_bytes` together. The surfaces of the largest bundle in view are chosen
// in any case. Proxy levels of detail come next, largest first, for up to a quarter of the memory, so that no
// part of the world is empty. The remaining steps follow by value. Surfaces have more value than shadows, and
// these more than their finer detail, unless another bundle is much larger in view.
void choose(std::span<Interest* const> bundles, std::uint64_t max_bytes);

}  // namespace lambent::streaming
