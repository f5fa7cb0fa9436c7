// Keeps how long the last frames took, and measures how smooth they are: median, worst, how many took more
// than twice the median, and a histogram. UploadPacer chooses upload budgets from these times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lambent::frame {

class FrameTimes {
 public:
  explicit FrameTimes(std::size_t kept = 240) : kept_(kept) {}

  void add(double milliseconds);

  std::size_t count() const { return times_ms_.size(); }
  double last() const { return times_ms_.empty() ? 0.0 : times_ms_[last_]; }
  // Returns the time in milliseconds that this share (0..1) of the frames did not exceed; 0 without frames.
  double quantile(double share) const;
  double median() const { return quantile(0.5); }
  double worst() const { return quantile(1.0); }
  std::size_t overTwiceMedian() const;
  // Counts frames by their time relative to the median: bin i counts those from i / 4 to (i + 1) / 4 of it,
  // and the last bin all longer ones.
  std::vector<std::size_t> histogram(std::size_t bins = 12) const;

 private:
  std::size_t kept_;
  std::vector<double> times_ms_;
  std::size_t last_ = 0;
};

// Chooses how many bytes to upload in a frame. The budget halves after an uploading frame that took much
// longer than usual, and grows by a tenth after any other that uploaded. It has a lower limit, so that slow
// frames do not starve loading.
class UploadPacer {
 public:
  std::uint64_t budget(std::uint64_t most_bytes) const;
  // Returns for how many seconds a frame may wait for what is being loaded: a share of the last frame if that
  // was slow, so that loading takes few frames, and else 0.
  double waitSeconds() const;
  // Records the time of the last frame, and whether it uploaded anything.
  void frameTook(double milliseconds, bool uploaded, std::uint64_t most_bytes);

 private:
  FrameTimes times_{64};
  double bytes_ = 0.0;  // 0: no frame yet
};

}  // namespace lambent::frame
