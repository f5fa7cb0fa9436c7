#include "runtime/bundle/entropy_coder.hpp"

#include <cassert>

#include <zstd.h>

#include "runtime/base/payload_bytes.hpp"

namespace lambent::bundle {

std::vector<std::byte> compressZstd(std::span<const std::byte> bytes, int level) {
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
  assert(!ZSTD_isError(size) && "the destination is as large as ZSTD_compressBound asks");
  out.resize(size);
  return out;
}

Result<std::vector<std::byte>> decompressZstd(std::span<const std::byte> bytes, std::size_t raw_length,
                                              const std::string& subject) {
  // The frame says how much it holds: a false raw_length cannot make us allocate what is not there.
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != raw_length)
    return fail(subject, "has a damaged payload: it does not hold as many bytes as it says", kCopyAgain);
  std::vector<std::byte> out(raw_length);
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) || size != raw_length)
    return fail(subject, "has a damaged payload: it cannot be decompressed", kCopyAgain);
  return out;
}

}  // namespace lambent::bundle
