// What a bundle is brought in, piece by piece, and what each takes on the GPU: first the capture proxies of
// its groups, which stand in for it where there is no room for more; then all that shows its surfaces and
// volumes without shadows; then of each rigid group the codebooks of its transfer, then weight planes, a
// share of them at a time. Made from a checked bundle's description; what follows the camera (interest.hpp)
// chooses among these.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/reader.hpp"
#include "runtime/streaming/work.hpp"

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
  // meshes, rows, textures, volumes. Then of each group its transfer; some are empty.
  std::vector<Unit> units;

  // How many steps of the first unit show the surfaces; with fewer, a stand-in is there or nothing.
  std::uint32_t surfaceSteps() const { return static_cast<std::uint32_t>(units.front().size()); }
  bool hasStandIn() const { return surfaceSteps() > 1; }

  // How many planes of a transfer belong to the first `steps` steps of the group's unit.
  std::uint32_t planesIn(std::uint32_t group, std::uint32_t steps, std::uint32_t cell,
                         std::uint32_t transfer) const;
};

// Where room is `limited`, looks into images for their sizes, and proxies come first, to stand in for the
// rest; else textures count as nothing. Errors: an image that cannot be read.
Result<Parts> partsOf(const bundle::Reader& reader, bool limited);

}  // namespace lambent::streaming
