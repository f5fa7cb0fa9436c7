// Records how far a bake is, so that a later run that goes on with it begins to count where it was. The
// record lies in the cache beside the results that it counts, under the same scene and options. It is written
// while the bake runs, as of one interval of checkpoints ago, because only what is that old is surely kept;
// at the end of a bake that was stopped it is of that moment. A record is no promise: without what it counts,
// a bake takes longer than it says.
#pragma once

#include <thread>

#include "baker/cache/cache.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/job_estimate.hpp"

namespace lambent::baker {

struct ProgressRecord {
  double share = 0.0;  // that was shown, 0..1
  PartSeconds spent;   // by all runs together, on what was kept
};

Key progressKey(const Scene& scene, const BakeOptions& options);
// Returns an empty record if there is none.
ProgressRecord findProgress(const Key& key, const Cache& cache);

// Keeps the record while it lives. Cache and progress must outlive it.
class ProgressKeeper {
 public:
  ProgressKeeper(const Progress& progress, PartSeconds expected, ProgressRecord begun, Cache& cache,
                 const Key& key);
  ProgressKeeper(const ProgressKeeper&) = delete;
  ProgressKeeper& operator=(const ProgressKeeper&) = delete;
  ~ProgressKeeper();

 private:
  std::jthread thread_;
};

}  // namespace lambent::baker
