// Records how far a bake is, so that a later run that goes on with it begins to count where it was. The
// record lies in the cache beside the results that it counts, under the same scene and options. A record is
// no promise: a bake that was killed may have kept less than it counts, and takes longer than it says.
#pragma once

#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/whole_progress.hpp"

namespace lambent::baker {

Key progressKey(const Scene& scene, const BakeOptions& options);
// Returns the share that was reached, 0..1; 0 if there is no record.
double findProgress(const Key& key, const Cache& cache);
// Keeps the record while the result lives. The cache must outlive it too.
ProgressWatch keepProgress(const Progress& progress, WholeProgress whole, Cache& cache, const Key& key);

}  // namespace lambent::baker
