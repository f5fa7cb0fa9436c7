// Compresses and decompresses all payloads, with zstd. Damaged or truncated bytes are reported as an Error
// that names `subject`.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::bundle {

std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level);
Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject);

}  // namespace lambent::bundle
