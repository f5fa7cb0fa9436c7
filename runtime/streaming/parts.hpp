// What a bundle is brought in, piece by piece, and what each takes on the GPU: first the capture proxies of
// its groups, which stand in for it where there is no room for more; then all that shows its surfaces and
// volumes without shadows, textures from a coarse level on; then of each rigid group the codebooks of its
// transfer, then weight planes, a share of them at a time; of each texture its finer levels, one by one. Made
// from a checked bundle's description; what follows the camera (interest.hpp) chooses among these.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/load_request.hpp"

namespace lambent::streaming {

// Brought and left away as a whole.
struct Step {
  std::vector<Work> work;
  std::uint64_t bytes = 0;
};

// Steps of a unit come one after the other and go from the last.
using Unit = std::vector<Step>;

struct Parts {
  // The first: proxies, as a step of their own where there are any and others may need the room; then
  // meshes, rows, textures, volumes. Then of each group its transfer, then of each image its finer levels;
  // some are empty, and those of images all are where room is not limited.
  std::vector<Unit> units;
  struct Image {
    std::uint32_t width = 0, height = 0;
    std::uint32_t coarse = 0;           // the finest level of the first unit
    std::vector<std::uint32_t> groups;  // that are drawn with it
  };
  std::vector<Image> images;

  std::size_t firstImageUnit() const { return units.size() - images.size(); }
  bool isImage(std::size_t unit) const { return unit >= firstImageUnit(); }
  const Image& imageOf(std::size_t unit) const { return images[unit - firstImageUnit()]; }

  // How many steps of the first unit show the surfaces; with fewer, a proxy level of detail is there or
  // nothing.
  std::uint32_t surfaceSteps() const { return static_cast<std::uint32_t>(units.front().size()); }
  bool hasProxyLod() const { return surfaceSteps() > 1; }

  // How many planes of a transfer belong to the first `steps` steps of the group's unit.
  std::uint32_t planesIn(std::uint32_t group, std::uint32_t steps, std::uint32_t cell,
                         std::uint32_t transfer) const;
  // How many mip levels of an image are here with the first `steps` steps of its unit.
  std::uint32_t levelsIn(std::size_t unit, std::uint32_t steps) const;

  // All of these steps, in order; of an image's levels the finest alone, for it brings the others.
  std::vector<Work> workOf(const std::vector<std::uint32_t>& steps) const;
};

// Where room is `limited`, looks into images for their sizes, and proxies come first, to stand in for the
// rest; else textures count as nothing. Errors: an image that cannot be read.
Result<Parts> partsOf(const bundle::Reader& reader, bool limited);

}  // namespace lambent::streaming
