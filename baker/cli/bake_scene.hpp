// Bakes for `lambent bake`: one scene, or all of a folder, once or whenever they change. Bakes are recorded
// in the journal, progress is shown, and a bundle that is up to date is left alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "baker/bake/bake.hpp"
#include "baker/cache/cache.hpp"
#include "baker/cli/output.hpp"
#include "baker/pipeline/journal.hpp"
#include "runtime/base/result.hpp"

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

using BakeOutcome = std::optional<BakeReport>;

// Returns the report, or nothing if the bundle was up to date.
Result<BakeOutcome> bakeScene(const BakeArguments& arguments, std::optional<Cache>& cache,
                              const std::stop_token& stop);
// Returns whether the bake missed a bound and is to fail for it.
bool failsStrictly(const BakeArguments& arguments, const BakeOutcome& outcome);
nlohmann::json outcomeJson(const BakeArguments& arguments, const BakeOutcome& outcome);

// Opens the cache that the arguments name, if any. A bake without a cache is only slower, so a problem with
// the folder is reported and no error.
std::optional<Cache> bakeCache(const BakeArguments& arguments);
// The journal of this program lies in the cache's folder.
Journal bakeJournal(const std::optional<Cache>& cache);

// Bakes every scene of the folder `arguments.scene` once. `arguments.output` is a folder for bundles, or
// empty: beside the scenes. Returns the exit code: 1 if a scene has no bundle that shows it as it is.
int bakeFolder(const BakeArguments& arguments, std::optional<Cache>& cache, const std::stop_token& stop);

// Bakes every scene of the folder `arguments.watch`, then again what changes, until it is interrupted.
// Returns the exit code: 1 if a scene is broken or its last bake failed.
int watchFolder(const BakeArguments& arguments, Cache* cache);

// Says where each scene of a folder is baked to, for --watch and for bakes of folders: beside the scene, or
// under a folder for bundles that mirrors the scenes' own.

class FolderOutputs {
 public:
  // If `output` is empty, bundles lie beside their scenes.
  FolderOutputs(std::filesystem::path folder, std::filesystem::path output)
      : folder_(std::move(folder)), output_(std::move(output)) {}

  // Returns the bundle, whose folder it makes. Fails if another scene, as a.gltf beside a.glb, has it.
  Result<std::filesystem::path> outputOf(const std::filesystem::path& scene);
  // Gives the bundle of a scene that is gone to others.
  void forget(const std::filesystem::path& scene);

 private:
  std::filesystem::path folder_, output_;
  std::map<std::filesystem::path, std::filesystem::path> scene_of_;  // by output
};

}  // namespace lambent::baker
