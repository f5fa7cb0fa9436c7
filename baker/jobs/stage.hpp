// A stage of a bake is work over many items in ranges. It declares what it writes and has a function that
// computes a range; everything that it reads is covered by the key of its context. runStage() does all else:
// it runs ranges on all threads, counts progress, stops, keeps finished ranges in the cache every few
// seconds, and begins with all that an earlier run of the same stage kept. The result does not depend on the
// order in which ranges finish, on the number of threads, or on where a run was cut short.
//
// An entry of the cache holds any ranges of a stage, and a stage's entries are numbered under its key. New
// entries are added, and none is written twice.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/cache/key.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Keeps whole results in the cache, under the key of a context, by write() and read() (cache/key.hpp).

// Returns whether the value was found.
template <typename T>
bool findKept(const BakeContext& context, T&& value) {
  if (!context.keeps()) return false;
  const auto bytes = context.cache->find(context.key);
  if (!bytes) return false;
  ByteReader in(*bytes);
  if (!read(in, value) || !in.atEnd()) return false;
  context.progress.found();
  return true;
}

template <typename T>
void keepValue(const BakeContext& context, const T& value) {
  if (!context.keeps()) return;
  ByteWriter out;
  write(value, out);
  context.cache->put(context.key, out.bytes());
}

inline void dropValue(const BakeContext& context) {
  if (context.keeps()) context.cache->drop(context.key);
}

// Finds the value, or calls make() to fill all of it and keeps it. make() returns false if it failed or was
// stopped. Returns whether the value was found, or nothing if make() returned false.
template <typename T, typename Make>
std::optional<bool> findOrMake(const BakeContext& context, T&& value, const Make& make) {
  if (findKept(context, value)) return true;
  if (!make()) return std::nullopt;
  keepValue(context, value);
  return false;
}

// An Output is something that a stage writes, packed as bytes for ranges of its items. Both functions are
// called from any thread, and for different ranges at the same time.
struct Output {
  std::function<void(std::size_t begin, std::size_t end, ByteWriter& out)> write;
  // Puts back what write() wrote; returns false if the bytes are not those of such a range.
  std::function<bool(std::size_t begin, std::size_t end, ByteReader& in)> read;
};

// Returns the row of an item, if that of item 0 is `first_row`. Items with a negative row have none.
inline std::size_t rowOfItem(std::size_t item, std::ptrdiff_t first_row) {
  return static_cast<std::size_t>(std::max(static_cast<std::ptrdiff_t>(item) + first_row, std::ptrdiff_t{0}));
}

// Returns an output that is a list with rows of `width` values, by rowOfItem(). The list must outlive the
// stage and already have its full length.
template <typename List>
Output rowsOf(List& list, std::size_t width = 1, std::ptrdiff_t first_row = 0) {
  const std::span values(list);
  const auto rows = [values, width, first_row](std::size_t begin, std::size_t end) {
    const std::size_t first = width * rowOfItem(begin, first_row), last = width * rowOfItem(end, first_row);
    return values.subspan(first, last - first);
  };
  using Value = typename decltype(values)::value_type;
  return {
      [rows](std::size_t begin, std::size_t end, ByteWriter& out) {
        out.addList(std::span<const Value>(rows(begin, end)));
      },
      [rows](std::size_t begin, std::size_t end, ByteReader& in) { return in.readInto(rows(begin, end)); }};
}

enum class KeepWhen : std::uint8_t {
  Always,  // Later bakes read it, too: a range is packed right after it was computed, on the same thread.
  Due,  // Only checkpoints read it: ranges are packed by any thread once one is due, or when the bake stops.
};

struct Stage {
  // The name that progress shows; a stage without one counts on in the progress stage before it.
  std::string name = {};
  std::string unit = "samples";
  std::size_t count = 0;  // items
  std::size_t grain = 1;  // items in a range, > 0
  std::vector<Output> writes = {};
  // Computes items [begin, end); called from many threads, once for each range that was not found.
  std::function<void(std::size_t begin, std::size_t end)> compute = {};
  KeepWhen keep = KeepWhen::Due;
};

struct StageFigures {
  std::size_t computed = 0, found = 0;  // items
};

// Returns nothing if it was stopped. Without a cache or a key in the context, nothing is kept.
std::optional<StageFigures> runStage(const Stage& stage, const BakeContext& context);

// Removes what was kept of a stage of so many items, such as checkpoints once the result that they led to is
// kept.
void dropStage(const BakeContext& context, std::size_t count, std::size_t grain);

}  // namespace lambent::baker
