// Estimates how long a bake will take, in seconds of each stage, part by part: what comes before its groups,
// then each group, then the writing (Progress::beginPart). The first estimate is from the size of the scene
// and wrong by a factor of a few (guess_seconds.hpp); a better one comes from the coarse preview once that is
// done, and the best from the previous bake. Measured times replace estimates as stages run. All functions
// are pure.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

using StageSeconds = std::map<std::string, double>;
using PartSeconds = std::vector<StageSeconds>;

inline constexpr const char* kRefinement = "refinement";
// The stage in which all bounces but the first are passed on (bounces.hpp), and its share of a pass that
// gathers light.
inline constexpr const char* kBetweenPatches = "bounce between patches";
inline constexpr double kPatchShare = 0.3;
// Returns the number of passes that gather light.
int gatheredBounces(const BakeOptions& options);
// Returns the number of cells of a grid, and 1 at least.
double cellsOf(const glm::uvec3& grid);
// Returns whether the stage is one of the passes in which light bounces.
bool isBounce(std::string_view stage);

// Estimates a bake from the stages of a bake of the same scene with other options.
PartSeconds scaleSeconds(std::span<const Progress::Stage> stages, const BakeOptions& of,
                         const BakeOptions& to);
// Sorts what stages took by part and name.
PartSeconds partSeconds(std::span<const Progress::Stage> stages);
// Adds to what a stage takes.
void addSeconds(PartSeconds& parts, const Progress::Stage& stage, double seconds);
// Sums up the parts, name by name.
StageSeconds stageSeconds(const PartSeconds& parts);
double sumSeconds(const PartSeconds& parts);

// Returns the seconds left of a bake that was expected to take `expected`, has finished these stages and is
// at `now`. `before` is what earlier runs of the same bake spent on stages whose results were kept.
double secondsLeft(const PartSeconds& expected, const PartSeconds& before,
                   std::span<const Progress::Stage> finished, const Progress::Stage& now);
// Returns how long the stage took to get where it is, earlier runs included.
double secondsOf(const Progress::Stage& now, const PartSeconds& before,
                 std::span<const Progress::Stage> finished);

void writeSeconds(const PartSeconds& parts, ByteWriter& out);
bool readSeconds(ByteReader& in, PartSeconds& parts);

}  // namespace lambent::baker
