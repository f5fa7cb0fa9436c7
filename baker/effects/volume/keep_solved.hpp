// The solution of a block of columns, kept as soon as it is there: the next block may take long, too.
#pragma once

#include <span>

#include "baker/cache/cached_ranges.hpp"
#include "baker/effects/volume/gmres.hpp"

namespace lambent::baker {

// solve(Keep of its checkpoints) -> GmresResult fills `result`, unless it was kept.
template <typename Solve>
GmresResult keepSolved(const Keep& keep, std::span<float> result, const Solve& solve) {
  GmresResult done;
  cachedValue(
      keep.part("solved"),
      [&](ByteReader& in) {
        return in.read(done.iterations) && in.read(done.residual) && in.readInto(result);
      },
      [&] {
        done = solve(keep);
        return !done.stopped;
      },
      [&](ByteWriter& out) {
        out.add(done.iterations), out.add(done.residual);
        out.addList(std::span<const float>(result));
      });
  return done;
}

inline void dropSolved(const Keep& keep) {
  if (keep.cache) keep.cache->drop(keep.part("solved").key);
}

}  // namespace lambent::baker
