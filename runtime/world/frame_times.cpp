#include "runtime/world/frame_times.hpp"

#include <algorithm>
#include <cmath>

namespace lambent::frame {

namespace {

constexpr double kLonger = 1.35;  // times the median; a longer frame uploaded too much
constexpr double kGrow = 1.1, kShrink = 0.5;
constexpr double kFirstBytes = 1 << 20, kLeastBytes = 128 << 10;
// Holds however slow frames are: else a scene whose frames take seconds would take minutes to load.
constexpr double kLeastBytesPerSecond = 8 << 20;
// Nobody sees a quarter more in a frame that is no movement anyway.
constexpr double kSlowSeconds = 0.25, kWaitShare = 0.25;

}  // namespace

void FrameTimes::add(double milliseconds) {
  if (times_ms_.size() < kept_) {
    last_ = times_ms_.size();
    times_ms_.push_back(milliseconds);
  } else {
    last_ = (last_ + 1) % kept_;
    times_ms_[last_] = milliseconds;
  }
}

double FrameTimes::quantile(double share) const {
  if (times_ms_.empty()) return 0.0;
  std::vector<double> sorted = times_ms_;
  const auto place = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size() - 1)));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(place), sorted.end());
  return sorted[place];
}

std::size_t FrameTimes::overTwiceMedian() const {
  const double limit = 2.0 * median();
  return static_cast<std::size_t>(
      std::ranges::count_if(times_ms_, [&](double time) { return time > limit; }));
}

std::vector<std::size_t> FrameTimes::histogram(std::size_t bins) const {
  std::vector<std::size_t> counts(bins, 0);
  const double usual = median();
  for (const double time : times_ms_) {
    const double place = usual > 0.0 ? 4.0 * time / usual : 0.0;
    ++counts[std::min(static_cast<std::size_t>(place), bins - 1)];
  }
  return counts;
}

std::uint64_t UploadPacer::budget(std::uint64_t most_bytes) const {
  if (bytes_ == 0.0) return std::min(most_bytes, static_cast<std::uint64_t>(kFirstBytes));
  return std::min(most_bytes, static_cast<std::uint64_t>(bytes_));
}

double UploadPacer::waitSeconds() const {
  const double last_s = 1e-3 * times_.last();
  return last_s > kSlowSeconds ? kWaitShare * last_s : 0.0;
}

void UploadPacer::frameTook(double milliseconds, bool uploaded, std::uint64_t most_bytes) {
  if (bytes_ == 0.0) bytes_ = kFirstBytes;
  // A frame without uploads says nothing of what uploads cost.
  if (uploaded && times_.count() > 0) {
    const bool longer = milliseconds > kLonger * times_.median();
    const double most = std::max(kLeastBytes, static_cast<double>(most_bytes));
    const double least = std::clamp(1e-3 * milliseconds * kLeastBytesPerSecond, kLeastBytes, most);
    bytes_ = std::clamp(bytes_ * (longer ? kShrink : kGrow), least, most);
  }
  times_.add(milliseconds);
}

}  // namespace lambent::frame
