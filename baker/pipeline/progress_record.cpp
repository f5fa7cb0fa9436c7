#include "baker/pipeline/progress_record.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "baker/bake/bake.hpp"
#include "baker/pipeline/whole_progress.hpp"

namespace lambent::baker {

namespace {

constexpr double kLookEvery_s = 1.0;

struct Looked {
  std::chrono::steady_clock::time_point when;
  ProgressRecord record;
};

void keep(const ProgressRecord& record, Cache& cache, const Key& key) {
  ByteWriter out;
  out.add(record.share);
  writeSeconds(record.spent, out);
  cache.put(key, out.bytes());
}

}  // namespace

Key progressKey(const Scene& scene, const BakeOptions& options) {
  KeyMaker key = KeyMaker::ofStage("progress");
  key.add(sceneDigest(scene));
  for (const auto& [name, word] : options.settings()) key.addText(name).addText(word);
  return key.key();
}

ProgressRecord findProgress(const Key& key, const Cache& cache) {
  ProgressRecord record;
  const auto bytes = cache.find(key);
  if (!bytes) return {};
  ByteReader in(*bytes);
  if (!in.read(record.share) || !readSeconds(in, record.spent) || !in.atEnd()) return {};
  return record;
}

ProgressKeeper::ProgressKeeper(const Progress& progress, PartSeconds expected, ProgressRecord begun,
                               Cache& cache, const Key& key) {
  thread_ = std::jthread([&progress, &cache, key, begun,
                          whole = WholeProgress(std::move(expected), begun)](std::stop_token stop) mutable {
    const std::chrono::duration<double> until_kept(cache.checkpointEvery());
    const std::chrono::duration<double> every(std::min(kLookEvery_s, cache.checkpointEvery()));
    const auto look = [&]() -> Looked {
      const WholeProgress::Seen seen = whole.look(progress);
      ProgressRecord record{.share = seen.share, .spent = begun.spent};
      for (const Progress::Stage& stage : progress.finished()) addSeconds(record.spent, stage, stage.seconds);
      if (!seen.stage.name.empty()) addSeconds(record.spent, seen.stage, seen.stage.seconds);
      return {std::chrono::steady_clock::now(), std::move(record)};
    };
    std::deque<Looked> fresh;  // what may not be kept yet
    std::mutex lock;
    std::condition_variable_any stopped;
    std::unique_lock hold(lock);
    while (!stopped.wait_for(hold, stop, every, [&] { return stop.stop_requested(); })) {
      fresh.push_back(look());
      std::optional<ProgressRecord> kept;
      for (; !fresh.empty() && fresh.front().when + until_kept < fresh.back().when; fresh.pop_front())
        kept = std::move(fresh.front().record);
      if (kept) keep(*kept, cache, key);
    }
    keep(look().record, cache, key);
  });
}

ProgressKeeper::~ProgressKeeper() = default;  // the jthread stops and joins

}  // namespace lambent::baker
