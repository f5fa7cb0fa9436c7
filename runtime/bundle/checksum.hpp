// XXH3-64, the checksum and digest of the whole format: fast enough to leave on, 64 bits against accidents
// (not against forgery).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lambent::bundle {

std::uint64_t checksum(std::span<const std::byte> bytes);

}  // namespace lambent::bundle
