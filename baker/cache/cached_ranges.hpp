// Work over ranges that survives being killed: parallelRanges (baker/jobs/parallel.hpp), but what finished
// ranges came to is kept in a cache as they finish, every few seconds, and a later run of the same work
// begins with all that was kept. What is computed is a function of the range alone, so that neither the order
// in which ranges finish, nor the number of threads, nor where a run was cut short shows in the result. When
// all ranges have been kept, the work costs reading.
//
// An entry holds some ranges, any; entries of one piece of work are numbered under its key. New ones are
// added, none is written twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

#include "baker/cache/bytes.hpp"
#include "baker/cache/cache.hpp"

namespace lambent::baker {

// Where a piece of work is kept.
struct Keep {
  Cache* cache = nullptr;  // null: nowhere
  Key key;                 // of all that it depends on

  // A part of the same work.
  template <PlainBytes... Values>
  Keep part(std::string_view name, const Values&... values) const {
    KeyMaker maker;
    maker.add(key).addText(name);
    (maker.add(values), ...);
    return {cache, maker.key()};
  }
};

struct RangeWork {
  // Computes [begin, end); called from many threads, once for a range that was not found.
  std::function<void(std::size_t begin, std::size_t end)> compute;
  // Writes what it came to.
  std::function<void(std::size_t begin, std::size_t end, ByteWriter& out)> pack;
  // Puts it back in place of compute. False where it does not fit: the range is computed.
  std::function<bool(std::size_t begin, std::size_t end, ByteReader& in)> unpack;
};

enum class KeepWhen : std::uint8_t {
  Always,  // for bakes to come, too: pack follows compute on the same thread
  Due,  // checkpoints alone: ranges are packed, by any thread, once Cache::checkpointDue(), or when stopped
};

struct CachedRanges {
  bool finished = false;              // else a stop was requested
  std::size_t ranges = 0, found = 0;  // how many there are, and how many of them were kept from before
  bool allFound() const { return finished && found == ranges; }
};

// keep: count and grain are added to its key. Without a cache this is parallelRanges.
CachedRanges cachedRanges(const Keep& keep, std::size_t count, std::size_t grain, const std::stop_token& stop,
                          const RangeWork& work, KeepWhen when = KeepWhen::Always);

// Removes what cachedRanges kept of this work: checkpoints, once what they led to is kept.
void dropRanges(const Keep& keep, std::size_t count, std::size_t grain);

// Puts back what was kept of such work, and computes nothing. False where some range is missing.
bool restoreRanges(const Keep& keep, std::size_t count, std::size_t grain,
                   const std::function<bool(std::size_t begin, std::size_t end, ByteReader& in)>& unpack);

// One result under one key, where there are no ranges: finds it, or makes and keeps it. read(ByteReader&) ->
// bool puts back what write(ByteWriter&) wrote; make() -> bool makes it, false where it failed or was
// stopped. Returns whether it was found, or nothing where make failed.
template <typename Read, typename Make, typename Write>
std::optional<bool> cachedValue(const Keep& keep, const Read& read, const Make& make, const Write& write) {
  if (keep.cache) {
    if (const auto bytes = keep.cache->find(keep.key)) {
      ByteReader in(*bytes);
      if (read(in) && in.atEnd()) return true;
    }
  }
  if (!make()) return std::nullopt;
  if (keep.cache) {
    ByteWriter out;
    write(out);
    keep.cache->put(keep.key, out.bytes());
  }
  return false;
}

}  // namespace lambent::baker
