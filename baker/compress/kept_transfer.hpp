// Stores coded transfer as bytes in the cache (baker/cache): after a bake that was cut short, the next run
// finds the transfers that were coded.
#pragma once

#include <span>
#include <vector>

#include "baker/cache/bytes.hpp"
#include "baker/compress/baked_grids.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

void write(const transfer::SharedCodebook& book, ByteWriter& out);
bool read(ByteReader& in, transfer::SharedCodebook& book);
void write(const CodedTransfer& coded, ByteWriter& out);
// Returns false, with `coded` partly changed, if the bytes are no such result.
bool read(ByteReader& in, CodedTransfer& coded);
void write(const CodedCell& cell, ByteWriter& out);
bool read(ByteReader& in, CodedCell& cell);

// Lists of any values that are kept.
template <typename T>
void write(const std::vector<T>& list, ByteWriter& out) {
  out.add(std::uint64_t{list.size()});
  for (const T& value : list) write(value, out);
}
template <typename T>
bool read(ByteReader& in, std::vector<T>& list) {
  std::uint64_t count = 0;
  if (!in.read(count)) return false;
  list.clear();
  for (std::uint64_t i = 0; i < count; ++i)
    if (!read(in, list.emplace_back())) return false;
  return true;
}

// Codes transfers that belong together, one after the other, on one thread.
class CachedCoding {
 public:
  explicit CachedCoding(const BakeContext& context) : context_(context) {}

  bool stopped() const { return context_.stopped(); }
  // Does what codeTransfer does; clusters and axes of the settings are those that it chooses.
  CodedTransfer code(std::span<const float> vectors, std::size_t count, const transfer::TransferShape& shape,
                     const CodingSettings& settings);
  // Removes the entries, once the result that all of them led to is kept.
  void drop();

 private:
  BakeContext context_;
  std::vector<Key> kept_;
};

}  // namespace lambent::baker
