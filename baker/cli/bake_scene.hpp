// Bakes one scene for `lambent bake`: it records the bake in the journal, shows progress, and leaves a bundle
// alone that is up to date. The caller prints what came of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "baker/bake/bake.hpp"
#include "baker/cli/output.hpp"
#include "baker/pipeline/bake_estimate.hpp"
#include "baker/pipeline/journal.hpp"

namespace lambent::baker {

struct BakeArguments {
  std::filesystem::path scene, output;
  std::filesystem::path watch;  // a folder; empty means none
  bool resume = false;
  double checkpoint_s = 0.0;  // 0 keeps the cache's own interval
  BakeOptions options;
  bool force = false, json = false, allow_outside = false;
  bool strict = false;  // a bake that misses a bound fails
  std::string cache;    // a folder, "off", or empty for the default one
  std::uint64_t cache_bytes = kCacheBytes;
  SayOptions say;
};

struct BakeOutcome {
  std::optional<BakeReport> report;  // nothing: the bundle was up to date
  std::optional<BakeEstimate> estimate;
};

Result<BakeOutcome> bakeScene(const BakeArguments& arguments, std::optional<Cache>& cache,
                              const std::stop_token& stop);
// Returns whether the bake missed a bound and is to fail for it.
bool failsStrictly(const BakeArguments& arguments, const BakeOutcome& outcome);
nlohmann::json outcomeJson(const BakeArguments& arguments, const BakeOutcome& outcome);

std::optional<Cache> bakeCache(const BakeArguments& arguments);
// The journal of this program lies in the cache's folder.
Journal bakeJournal(const std::optional<Cache>& cache);

}  // namespace lambent::baker
