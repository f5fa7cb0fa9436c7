// What ranges of samples traced, of diffuse and of glossy surfaces alike: how many rays, and what they met,
// painted for the store and, beside it, unpainted as bytes for whoever keeps what a range found
// (cache/cached_ranges.hpp).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "baker/cache/bytes.hpp"
#include "baker/effects/diffuse/direct.hpp"
#include "baker/effects/diffuse/hits.hpp"

namespace lambent::baker {

class TracedRanges {
 public:
  // Scene and store outlive it. keep_hits: bounces want them. packed: pack() will be called.
  TracedRanges(const DiffuseScene& scene, std::size_t samples, bool keep_hits, bool packed, HitStore& store);

  // From any thread, each range once: traced just now, or packed once before. What was stopped has no hits.
  void add(std::size_t range, std::uint64_t rays, RangeHits&& hits, const std::stop_token& stop);
  void pack(std::size_t range, ByteWriter& out);
  // samples: of the range. False where the bytes are not those of such a range.
  bool unpack(std::size_t range, std::size_t samples, ByteReader& in);

  // Once all are there.
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysUnpacked() const;

 private:
  void offer(std::size_t range, RangeHits&& hits);

  const DiffuseScene& scene_;
  HitStore& store_;
  bool keep_hits_, packed_;
  std::vector<std::uint64_t> rays_;
  std::vector<std::vector<std::byte>> unpainted_;  // hits, until they are packed
  std::atomic<std::uint64_t> traced_ = 0;
};

}  // namespace lambent::baker
