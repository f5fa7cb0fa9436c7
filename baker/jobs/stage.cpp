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

Key stageKey(const BakeContext& context, std::size_t count, std::size_t grain) {
  return KeyMaker().add(context.key).add(std::uint64_t{count}).add(std::uint64_t{grain}).key();
}

Key entryKey(const Key& stage, std::uint64_t number) {
  return KeyMaker().add(stage).add(number).key();
}

void append(std::size_t range, std::span<const std::byte> bytes, ByteWriter& out) {
  out.add(std::uint64_t{range});
  out.addList(bytes);
}

// The cache entries of one stage, and the ranges that have finished and are not yet written, packed or not.
class KeptRanges {
 public:
  KeptRanges(const Stage& stage, const BakeContext& context)
      : stage_(stage),
        cache_(*context.cache),
        key_(stageKey(context, stage.count, stage.grain)),
        ranges_((stage.count + stage.grain - 1) / stage.grain),
        done_(std::make_unique<std::atomic<bool>[]>(ranges_)) {}

  // Returns how many items were found.
  std::size_t load(const std::stop_token& stop) {
    while (cache_.has(entryKey(key_, next_))) ++next_;
    // Two entries hold the same range if two programs did the same work at once.
    const auto taken = std::make_unique<std::atomic<bool>[]>(ranges_);
    const auto damaged = std::make_unique<std::atomic<bool>[]>(next_);
    std::atomic<std::size_t> found = 0;
    parallelRanges(next_, 1, stop, [&](std::size_t entry, std::size_t) {
      const auto bytes = cache_.find(entryKey(key_, entry));
      damaged[entry] = !bytes;
      if (!bytes) return;
      ByteReader in(*bytes);
      while (!in.atEnd()) {
        std::uint64_t range = 0, size = 0;
        if (!in.read(range) || !in.read(size) || range >= ranges_) break;
        ByteReader own = in.part(size);
        if (!in.ok()) break;
        if (taken[range].exchange(true)) continue;
        if (!readRange(range, own)) continue;
        done_[range] = true;
        found += end(range) - begin(range);
      }
    });
    // Entries after a damaged one would not be found again, so its number is reused first.
    for (std::uint64_t e = 0; e < next_; ++e)
      if (damaged[e]) free_.push_back(e);
    return found;
  }
  bool done(std::size_t range) const { return done_[range]; }

  // These may be called from any thread.
  void addPacked(std::size_t range) {
    ByteWriter own;
    writeRange(range, own);
    std::vector<std::byte> full;
    {
      const std::lock_guard hold(lock_);
      append(range, own.bytes(), packed_);
      if (packed_.size() < kEntryBytes && !cache_.checkpointDue()) return;
      full = packed_.take();
      cache_.checkpointed();
    }
    put(full);  // without the lock, so that other threads go on
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
    if (packed_.size() > 0) put(packed_.take());
    write(std::exchange(finished_, {}));
  }

 private:
  std::size_t begin(std::size_t range) const { return range * stage_.grain; }
  std::size_t end(std::size_t range) const { return std::min(stage_.count, (range + 1) * stage_.grain); }

  void writeRange(std::size_t range, ByteWriter& out) const {
    for (const Output& output : stage_.writes) output.write(begin(range), end(range), out);
  }
  bool readRange(std::size_t range, ByteReader& in) const {
    return std::ranges::all_of(
               stage_.writes,
               [&](const Output& output) { return output.read(begin(range), end(range), in); }) &&
           in.atEnd();
  }
  void write(const std::vector<std::size_t>& ranges) {
    ByteWriter out, own;
    for (const std::size_t range : ranges) {
      writeRange(range, own);
      append(range, own.take(), out);
      if (out.size() >= kEntryBytes) put(out.take());
    }
    if (out.size() > 0) put(out.take());
  }
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
    cache_.put(entryKey(key_, number), bytes);
  }

  const Stage& stage_;
  Cache& cache_;
  Key key_;
  std::size_t ranges_;
  std::unique_ptr<std::atomic<bool>[]> done_;
  std::mutex lock_;  // protects the members below
  std::vector<std::uint64_t> free_;
  std::uint64_t next_ = 0;
  ByteWriter packed_;
  std::vector<std::size_t> finished_;
};

}  // namespace

std::optional<StageFigures> runStage(const Stage& stage, const BakeContext& context) {
  if (!stage.name.empty()) context.progress.begin(stage.name, stage.count, stage.unit);
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
  KeptRanges kept(stage, context);
  const std::size_t found = kept.load(context.stop);
  if (found > 0) context.progress.found(found);
  const auto began = std::chrono::steady_clock::now();
  const bool finished =
      parallelRanges(stage.count, stage.grain, context.stop, [&](std::size_t begin, std::size_t end) {
        const std::size_t range = begin / stage.grain;
        if (kept.done(range)) return;
        compute(begin, end);
        // A computation that was stopped may have left out a part of its range.
        if (context.stopped()) return;
        if (stage.keep == KeepWhen::Always)
          kept.addPacked(range);
        else
          kept.addFinished(range);
      });
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  if (stage.keep == KeepWhen::Always || !finished || found > 0 || took.count() > kWorthKeeping_s)
    kept.writeAll();
  if (!finished) return std::nullopt;
  return StageFigures{.computed = computed, .found = found};
}

void dropStage(const BakeContext& context, std::size_t count, std::size_t grain) {
  if (!context.keeps()) return;
  const Key key = stageKey(context, count, grain);
  for (std::uint64_t e = 0; context.cache->has(entryKey(key, e)); ++e) context.cache->drop(entryKey(key, e));
}

}  // namespace lambent::baker
