// Coded transfer as bytes to keep (baker/cache), and coding that may be cut short anywhere: what was coded is
// found by the next run of the same work, and what was being coded goes on from its last checkpoint.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "baker/cache/cached_ranges.hpp"
#include "baker/compress/cpca.hpp"

namespace lambent::baker {

void write(const bundle::SharedCodebook& book, ByteWriter& out);
bool read(ByteReader& in, bundle::SharedCodebook& book);
void write(const CodedTransfer& coded, ByteWriter& out);
// False, and any part changed, where the bytes are no such result.
bool read(ByteReader& in, CodedTransfer& coded);

// Of transfers that belong together, one after the other. One thread.
class CachedCoding {
 public:
  explicit CachedCoding(Cache* cache) : cache_(cache) {}

  // As codeTransfer; clusters and axes of the settings are those that it chooses.
  CodedTransfer code(std::span<const float> vectors, std::size_t count, const bundle::TransferShape& shape,
                     const CodingSettings& settings, const std::stop_token& stop);
  // What they all led to is kept.
  void drop();

 private:
  Cache* cache_;
  std::vector<Key> kept_;
};

}  // namespace lambent::baker
