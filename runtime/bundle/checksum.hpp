// XXH3-64 is the checksum and the digest of the whole format. It is fast enough to be checked on every read.
// It detects accidents, not forgery.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lambent::bundle {

std::uint64_t checksum(std::span<const std::byte> bytes);

}  // namespace lambent::bundle
