// Holds what ranges of samples traced, of diffuse and of glossy surfaces alike, as an output of the stage
// that traces: the numbers of rays, and their hits. The store gets hits with colours; the output keeps them
// without, so that traced results stay valid when colours change.
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
  // Scene and store must outlive this. `keep_hits` says that bounces need hits; `kept` says that output()
  // will be written.
  TracedRanges(const TracedScene& scene, std::size_t samples, bool keep_hits, bool kept, HitStore& store);

  // Takes the result of a range that was traced just now. May be called from any thread, once for each range.
  // If a stop was requested, the hits are not kept.
  void add(std::size_t range, std::uint64_t rays, RangeHits&& hits, const std::stop_token& stop);
  // Returns an output for a stage with ranges of kSamplesPerRange. It must not outlive this.
  Output output();

  // May be called once all ranges are there.
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
  std::vector<std::vector<std::byte>> unpainted_;  // packed hits without colours, until they are written
  std::atomic<std::uint64_t> traced_ = 0;
};

}  // namespace lambent::baker
