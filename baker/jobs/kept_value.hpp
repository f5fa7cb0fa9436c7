// Keeps whole results in the cache, under the key of a context. A type is kept by two functions beside it:
// `void write(const T&, ByteWriter&)`, and `bool read(ByteReader&, T&)`, which returns false if the bytes are
// no such value, and may have changed a part of it by then. T may be a view of where the value lies.
#pragma once

#include <optional>

#include "baker/cache/bytes.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

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

}  // namespace lambent::baker
