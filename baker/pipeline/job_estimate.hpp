// How long a job will take: seconds by the name of the stage, for all groups together. At first from the size
// of the scene, which is wrong by a factor of a few; from what the coarse preview_level took once that is
// done; best of all from the last time. What stages really take replaces it as they run. Pure functions of
// their arguments.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"

namespace lambent::baker {

using StageSeconds = std::map<std::string, double>;

// Of a bake of which nothing is known but the scene.
StageSeconds guessSeconds(const Scene& scene, const BakeOptions& options);
// From the stages of a bake of the same scene under other options.
StageSeconds scaleSeconds(std::span<const Progress::Stage> stages, const BakeOptions& of,
                          const BakeOptions& to);
// As they were.
StageSeconds sumSeconds(std::span<const Progress::Stage> stages);

// What is left of a bake that was expected to take so long, has finished these stages and is at `now`.
double secondsLeft(const StageSeconds& expected, std::span<const Progress::Stage> finished,
                   const Progress::Stage& now);

}  // namespace lambent::baker
