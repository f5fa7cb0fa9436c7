#include "baker/jobs/stage.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

namespace {

constexpr double kWorthKeeping_s = 0.5;  // seconds; work that took less is not worth a checkpoint
constexpr std::size_t kEntryBytes = std::size_t{8} << 20;  // approximate size of an entry with many ranges

struct Cut {
  std::size_t count, grain;
  std::size_t ranges() const { return (count + grain - 1) / grain; }
  std::size_t begin(std::size_t range) const { return range * grain; }
  std::size_t end(std::size_t range) const { return std::min(count, (range + 1) * grain); }
};

void writeRange(const Stage& stage, std::size_t begin, std::size_t end, ByteWriter& out) {
  for (const Output& output : stage.writes) output.write(begin, end, out);
}

bool readRange(const Stage& stage, std::size_t begin, std::size_t end, ByteReader& in) {
  return std::ranges::all_of(stage.writes,
                             [&](const Output& output) { return output.read(begin, end, in); }) &&
         in.atEnd();
}

// Entries are the cache entries of one stage.
class Entries {
 public:
  Entries(const BakeContext& context, const Cut& cut)
      : cache_(*context.cache),
        key_(KeyMaker().add(context.key).add(std::uint64_t{cut.count}).add(std::uint64_t{cut.grain}).key()),
        cut_(cut),
        done_(std::make_unique<std::atomic<bool>[]>(cut.ranges())) {}

  // Returns how many items were found.
  std::size_t load(const Stage& stage, const std::stop_token& stop) {
    while (cache_.has(numbered(next_))) ++next_;
    // Two entries hold the same range if two programs did the same work at once.
    const auto taken = std::make_unique<std::atomic<bool>[]>(cut_.ranges());
    const auto damaged = std::make_unique<std::atomic<bool>[]>(next_);
    std::atomic<std::size_t> found = 0;
    parallelRanges(next_, 1, stop, [&](std::size_t entry, std::size_t) {
      const auto bytes = cache_.find(numbered(entry));
      damaged[entry] = !bytes;
      if (!bytes) return;
      ByteReader in(*bytes);
      while (!in.atEnd()) {
        std::uint64_t range = 0, size = 0;
        if (!in.read(range) || !in.read(size) || range >= cut_.ranges()) break;
        ByteReader own = in.part(size);
        if (!in.ok()) break;
        if (taken[range].exchange(true)) continue;
        if (!readRange(stage, cut_.begin(range), cut_.end(range), own)) continue;
        done_[range] = true;
        found += cut_.end(range) - cut_.begin(range);
      }
    });
    // Entries after a damaged one would not be found again, so its number is reused first.
    for (std::uint64_t e = 0; e < next_; ++e)
      if (damaged[e]) free_.push_back(e);
    return found;
  }
  bool done(std::size_t range) const { return done_[range]; }

  // May be called from any thread.
  void put(std::span<const std::byte> bytes) {
    std::uint64_t number = 0;
    {
      const std::lock_guard hold(lock_);
      if (free_.empty()) {
        number = next_++;
      } else {
        number = free_.back();
        free_.pop_back();
      }
    }
    cache_.put(numbered(number), bytes);
  }
  void dropAll() {
    for (std::uint64_t e = 0; cache_.has(numbered(e)); ++e) cache_.drop(numbered(e));
  }

 private:
  Key numbered(std::uint64_t number) const { return KeyMaker().add(key_).add(number).key(); }

  Cache& cache_;
  Key key_;
  Cut cut_;
  std::unique_ptr<std::atomic<bool>[]> done_;
  std::mutex lock_;  // protects the members below
  std::vector<std::uint64_t> free_;
  std::uint64_t next_ = 0;
};

void append(std::size_t range, std::span<const std::byte> bytes, ByteWriter& out) {
  out.add(std::uint64_t{range});
  out.addList(bytes);
}

// Waiting holds the ranges that have finished and are not yet written, packed or not.
class Waiting {
 public:
  Waiting(const Stage& stage, Cache& cache, Entries& entries, const Cut& cut)
      : stage_(stage), cache_(cache), entries_(entries), cut_(cut) {}

  void addPacked(std::size_t range) {
    ByteWriter own;
    writeRange(stage_, cut_.begin(range), cut_.end(range), own);
    std::vector<std::byte> full;
    {
      const std::lock_guard hold(lock_);
      append(range, own.bytes(), packed_);
      if (packed_.size() < kEntryBytes && !cache_.checkpointDue()) return;
      full = packed_.take();
      cache_.checkpointed();
    }
    entries_.put(full);  // without the lock, so that other threads go on
  }
  void addFinished(std::size_t range) {
    std::vector<std::size_t> ranges;
    {
      const std::lock_guard hold(lock_);
      finished_.push_back(range);
      if (!cache_.checkpointDue()) return;
      ranges = std::exchange(finished_, {});
      cache_.checkpointed();
    }
    write(ranges);
  }
  // Is called once all ranges are done.
  void writeAll() {
    if (packed_.size() > 0) entries_.put(packed_.take());
    write(std::exchange(finished_, {}));
  }

 private:
  void write(const std::vector<std::size_t>& ranges) {
    ByteWriter out, own;
    for (const std::size_t range : ranges) {
      writeRange(stage_, cut_.begin(range), cut_.end(range), own);
      append(range, own.take(), out);
      if (out.size() >= kEntryBytes) entries_.put(out.take());
    }
    if (out.size() > 0) entries_.put(out.take());
  }

  const Stage& stage_;
  Cache& cache_;
  Entries& entries_;
  Cut cut_;
  std::mutex lock_;  // protects the members below
  ByteWriter packed_;
  std::vector<std::size_t> finished_;
};

}  // namespace

std::optional<StageFigures> runStage(const Stage& stage, const BakeContext& context) {
  if (!stage.name.empty()) context.progress.begin(stage.name, stage.count, stage.unit);
  const Cut cut{stage.count, stage.grain};
  std::atomic<std::size_t> computed = 0;
  const auto compute = [&](std::size_t begin, std::size_t end) {
    stage.compute(begin, end);
    computed += end - begin;
    context.progress.add(end - begin);
  };
  if (!context.keeps()) {
    if (!parallelRanges(stage.count, stage.grain, context.stop, compute)) return std::nullopt;
    return StageFigures{.computed = computed};
  }
  Entries entries(context, cut);
  const std::size_t found = entries.load(stage, context.stop);
  if (found > 0) context.progress.found(found);
  Waiting waiting(stage, *context.cache, entries, cut);
  const auto began = std::chrono::steady_clock::now();
  const bool finished =
      parallelRanges(stage.count, stage.grain, context.stop, [&](std::size_t begin, std::size_t end) {
        const std::size_t range = begin / stage.grain;
        if (entries.done(range)) return;
        compute(begin, end);
        // A computation that was stopped may have left out a part of its range.
        if (context.stopped()) return;
        if (stage.keep == KeepWhen::Always)
          waiting.addPacked(range);
        else
          waiting.addFinished(range);
      });
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  if (stage.keep == KeepWhen::Always || !finished || found > 0 || took.count() > kWorthKeeping_s)
    waiting.writeAll();
  if (!finished) return std::nullopt;
  return StageFigures{.computed = computed, .found = found};
}

void dropStage(const BakeContext& context, std::size_t count, std::size_t grain) {
  if (context.keeps()) Entries(context, {count, grain}).dropAll();
}

}  // namespace lambent::baker
