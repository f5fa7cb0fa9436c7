#include "runtime/bundle/checksum.hpp"

#include <xxhash.h>

namespace lambent::bundle {

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace lambent::bundle
