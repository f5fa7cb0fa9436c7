// What ranges of samples traced, of diffuse and of glossy surfaces alike, as an output of the stage that
// traces: how many rays, and what they met. Hits are painted for the store; beside it they are kept
// unpainted, so that what was traced stays good when colours change.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "baker/jobs/stage.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/traced_scene.hpp"

namespace lambent::baker {

class TracedRanges {
 public:
  // Scene and store outlive it. keep_hits: bounces want them. kept: output() will be written.
  TracedRanges(const TracedScene& scene, std::size_t samples, bool keep_hits, bool kept, HitStore& store);

  // Takes what a range traced just now; from any thread, each range once. What was stopped has no hits.
  void add(std::size_t range, std::uint64_t rays, RangeHits&& hits, const std::stop_token& stop);
  // The output of a stage with ranges of kSamplesPerRange, which must not outlive this.
  Output output();

  // Once all are there.
  std::uint64_t raysTraced() const { return traced_; }
  std::uint64_t raysFound() const;

 private:
  void write(std::size_t range, ByteWriter& out);
  bool read(std::size_t range, std::size_t samples, ByteReader& in);
  void offer(std::size_t range, RangeHits&& hits);

  const TracedScene& scene_;
  HitStore& store_;
  bool keep_hits_, kept_;
  std::vector<std::uint64_t> rays_;
  std::vector<std::vector<std::byte>> unpainted_;  // hits, until they are written
  std::atomic<std::uint64_t> traced_ = 0;
};

}  // namespace lambent::baker
