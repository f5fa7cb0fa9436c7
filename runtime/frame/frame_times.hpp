// How long the last frames took, and what that says of smoothness: median, worst, how many took more than
// twice the median, a histogram. A value; whoever measures adds. The upload budget goes by it (pacer below):
// less is brought where frames take longer than usual, more where they do not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lambent::frame {

class FrameTimes {
 public:
  explicit FrameTimes(std::size_t kept = 240) : kept_(kept) {}

  void add(double milliseconds);
  void clear() { times_ms_.clear(); }

  std::size_t count() const { return times_ms_.size(); }
  double last() const { return times_ms_.empty() ? 0.0 : times_ms_[last_]; }
  // Share 0..1 of the frames took no longer; 0 without frames.
  double quantile(double share) const;
  double median() const { return quantile(0.5); }
  double worst() const { return quantile(1.0); }
  std::size_t overTwiceMedian() const;
  // Frames by time over the median: bin i counts those from i / 4 to (i + 1) / 4 of it, the last all beyond.
  std::vector<std::size_t> histogram(std::size_t bins = 12) const;
  const std::vector<double>& times() const { return times_ms_; }  // in no order

 private:
  std::size_t kept_;
  std::vector<double> times_ms_;
  std::size_t last_ = 0;
};

// The bytes to upload in a frame, from how long frames take: half of what it was after one that took much
// longer than usual, a little more after each that did not; never so little that slow frames starve what
// loads.
class UploadPacer {
 public:
  std::uint64_t budget(std::uint64_t most_bytes) const;
  // What the last frame took beside the frames before it, and whether it uploaded anything.
  void frameTook(double milliseconds, bool uploaded, std::uint64_t most_bytes);
  const FrameTimes& times() const { return times_; }

 private:
  FrameTimes times_{64};
  double bytes_ = 0.0;  // 0: nothing known yet
};

}  // namespace lambent::frame
