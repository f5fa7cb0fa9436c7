// Estimates how long a job will take, in seconds per stage name, for all groups together. The first estimate
// is from the size of the scene and wrong by a factor of a few; a better one comes from the coarse preview
// once that is done, and the best from the previous bake. Measured times replace estimates as stages run. All
// functions are pure.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/cache/bytes.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

using StageSeconds = std::map<std::string, double>;

// Returns whether the stage is one of the passes in which light bounces.
bool isBounce(std::string_view stage);

// Estimates a bake from the scene alone.
StageSeconds guessSeconds(const Scene& scene, const BakeOptions& options);
// Estimates a bake from the stages of a bake of the same scene with other options.
StageSeconds scaleSeconds(std::span<const Progress::Stage> stages, const BakeOptions& of,
                          const BakeOptions& to);
// Sums up the stages of a bake by name.
StageSeconds sumSeconds(std::span<const Progress::Stage> stages);

double sumSeconds(const StageSeconds& stages);

// Returns the seconds left of a bake that was expected to take `expected`, has finished these stages and is
// at `now`. `before` is what earlier runs of the same bake spent on stages whose results were kept.
double secondsLeft(const StageSeconds& expected, const StageSeconds& before,
                   std::span<const Progress::Stage> finished, const Progress::Stage& now);
// Returns how long the stage took to get where it is, earlier runs included.
double secondsOf(const Progress::Stage& now, const StageSeconds& before,
                 std::span<const Progress::Stage> finished);

void writeSeconds(const StageSeconds& stages, ByteWriter& out);
bool readSeconds(ByteReader& in, StageSeconds& stages);

}  // namespace lambent::baker
