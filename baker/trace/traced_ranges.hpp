// Holds what ranges of samples traced, of diffuse and of glossy surfaces alike, as an output of the stage
// that traces: the numbers of rays, and their hits. The store gets hits with colours; the output keeps them
// without, so that traced results stay valid when colours change.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "baker/jobs/stage.hpp"
#include "baker/trace/hits.hpp"
#include "baker/trace/traced_scene.hpp"

namespace lambent::baker {

class TracedRanges {
 public:
  // Gives the hits of samples that begin with `first` their colours (paintHits). It is called once all other
  // outputs of the range are there.
  using Paint = std::function<void(std::size_t first, RangeHits& hits)>;

  struct Settings {
    bool keep_hits;  // bounces need hits
    bool kept;       // output() will be written
  };
  // Scene and store must outlive this.
  TracedRanges(const TracedScene& scene, std::size_t samples, Settings settings, Paint paint,
               HitStore& store);

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
  Paint paint_;
  HitStore& store_;
  Settings settings_;
  std::vector<std::uint64_t> rays_;
  std::vector<std::vector<std::byte>> unpainted_;  // packed hits without colours, until they are written
  std::atomic<std::uint64_t> traced_ = 0;
};

}  // namespace lambent::baker
