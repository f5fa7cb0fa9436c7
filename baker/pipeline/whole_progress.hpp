// Combines the progress of many stages into one: the share of the expected work that is done, which never
// falls, and the time that is left. The caller says what each stage is expected to take, in each part of the
// job (Progress::beginPart); how long the work so far took says how long the rest takes. One thread at a time
// uses an object.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/progress.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

using StageSeconds = std::map<std::string, double>;
using PartSeconds = std::vector<StageSeconds>;

double sumSeconds(const PartSeconds& parts);

// Seconds of a job as they were expected: of what is done, by computation or since the cache held it, and of
// what is left. `pace` is how much longer the computed work took.
struct JobSeconds {
  double done = 0.0, left = 0.0, pace = 1.0;
};
// The last of the stages is the one that runs; those before are finished.
JobSeconds jobSeconds(const PartSeconds& expected, std::vector<Progress::Stage> stages);

class WholeProgress {
 public:
  // Jobs before and after this one count as parts of it: a preview counts with the bake that follows.
  explicit WholeProgress(PartSeconds expected, double before_s = 0.0, double after_s = 0.0)
      : expected_(std::move(expected)), before_s_(before_s), after_s_(after_s) {}

  struct Seen {
    double share = 0.0;  // 0..1
    double seconds_left = 0.0;
    double units_per_s = 0.0;  // of the running stage
    Progress::Stage stage;     // the running one; without a name if none runs
  };
  Seen look(const Progress& progress);

 private:
  PartSeconds expected_;
  double before_s_, after_s_, share_ = 0.0;
};

// Returns a thread that says how far a job is: every so often and, if wanted, once at the end. The progress
// must outlive it.
std::jthread watchProgress(const Progress& progress, WholeProgress whole, std::chrono::duration<double> every,
                           std::function<void(const WholeProgress::Seen&)> say, bool at_end = true);

// Guesses what a bake takes from its plan, its vertices and which way its faces look, which costs nothing. A
// guess may be wrong by a factor of two, of small scenes by four.

struct BakeGuess {
  double samples = 0.0, rays = 0.0;  // of surfaces
  PartSeconds seconds;               // on the threads that the options give it of this machine
  double processor_seconds = 0.0;    // on a processor of about 2020
  double memory_bytes = 0.0;         // of transfer of the largest group while it is baked
};
BakeGuess guessBake(const Scene& scene, const EffectPlan& plan, const BakeOptions& options);

// Returns a sentence for a bake that takes so much processor time, so that nobody waits for minutes unwarned,
// or nothing if that is not long.
std::optional<std::string> longBakeNotice(double processor_seconds);

}  // namespace lambent::baker
