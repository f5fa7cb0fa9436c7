// A bundle larger than the memory that it may take: which weight planes stay away. Everything else is always
// brought, and any prefix of a cell's planes renders, so a bundle loses detail, never surfaces. Planes are
// taken in the order of streaming until the next one has no room; from there on none is.
#pragma once

#include <cstdint>

#include "runtime/base/result.hpp"
#include "runtime/bundle/reader.hpp"

namespace lambent::streaming {

struct Budgeted {
  bundle::Description description;  // the bundle's, without the planes that stay away
  std::uint64_t bytes = 0;          // what it takes on the GPU, textures with their mip levels included
};

// Looks into the bundle's images for their sizes. Errors: an image that cannot be read.
Result<Budgeted> withinBudget(const bundle::Reader& reader, std::uint64_t max_bytes);

}  // namespace lambent::streaming
