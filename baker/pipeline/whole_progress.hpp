// Sees a job with many stages as one: the share of the whole that is done, which never falls, and the time
// that is left. The caller says what each stage is expected to take, in each part of the job
// (Progress::beginPart); measured times replace that as stages run. One thread at a time uses an object.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

using StageSeconds = std::map<std::string, double>;
using PartSeconds = std::vector<StageSeconds>;

inline constexpr const char* kRefinement = "refinement";

double sumSeconds(const PartSeconds& parts);

// Seconds of a job: spent, where what the cache held counts as though it had been computed, and left.
struct JobSeconds {
  double spent = 0.0, left = 0.0;
};
// Returns those of a job that was expected to take `expected`, has finished these stages and is at `now`.
JobSeconds jobSeconds(const PartSeconds& expected, std::span<const Progress::Stage> finished,
                      const Progress::Stage& now);

class WholeProgress {
 public:
  // `share` is that which an earlier run of the same job had reached (findProgress()). `others` are jobs
  // that count as parts of this one: a preview counts with the bake that follows.
  explicit WholeProgress(PartSeconds expected, double share = 0.0, JobSeconds others = {})
      : expected_(std::move(expected)), share_(share), others_(others) {}

  struct Seen {
    double share = 0.0;  // 0..1
    double seconds_left = 0.0;
    double units_per_s = 0.0;  // of the running stage
    Progress::Stage stage;     // the running one; without a name if none runs
  };
  Seen look(const Progress& progress);

 private:
  PartSeconds expected_;
  double share_;
  JobSeconds others_;
};

// While it lives, says how far a job is: every so often and, if wanted, once at the end, on a thread of its
// own. The progress must outlive it.
class ProgressWatch {
 public:
  ProgressWatch(const Progress& progress, WholeProgress whole, std::chrono::duration<double> every,
                std::function<void(const WholeProgress::Seen&)> say, bool at_end = true);

 private:
  std::jthread thread_;
};

// Records how far a bake is, so that a later run that goes on with it begins to count where it was. The
// record lies in the cache beside the results that it counts, under the same scene and options. A record is
// no promise: a bake that was killed may have kept less than it counts, and takes longer than it says.

Key progressKey(const Scene& scene, const BakeOptions& options);
// Returns the share that was reached, 0..1; 0 if there is no record.
double findProgress(const Key& key, const Cache& cache);
// Keeps the record while the result lives. The cache must outlive it too.
ProgressWatch keepProgress(const Progress& progress, WholeProgress whole, Cache& cache, const Key& key);

}  // namespace lambent::baker
