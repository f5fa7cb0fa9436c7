// Snapshots of bakes, and events, for a user interface. These are plain values that BakeQueue hands out.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/pipeline/bake_request.hpp"
#include "baker/pipeline/preview_levels.hpp"

namespace lambent::baker {

struct JobId {
  std::uint32_t value = 0;
  friend auto operator<=>(const JobId&, const JobId&) = default;
};

enum class JobPhase : std::uint8_t { Waiting, Importing, Baking, Done, Failed, Cancelled };

const char* phaseName(JobPhase phase);  // "waiting", "importing", ...

struct JobState {
  JobId id;
  BakeRequest request;
  JobPhase phase = JobPhase::Waiting;
  std::optional<PreviewLevel> preview_level;  // the level in progress, or the next one
  std::optional<PreviewLevel> reached;        // the best level that is complete, for the content added last
  // The bundle of `reached`, which is the one to show; empty before.
  std::filesystem::path bundle;

  Progress::Stage stage;               // the stage that runs now; its name is empty if none does
  double units_per_s = 0.0;            // rate of the stage
  double seconds = 0.0;                // time spent on the job so far, over all levels
  double fraction = 0.0;               // of the whole job, 0..1; never falls unless the job restarts
  std::optional<double> seconds_left;  // of the whole job; nothing while it is unknown

  std::optional<Error> error;         // of a job that failed
  std::vector<std::string> warnings;  // of the import and the journal, then the bake's notices
  bool up_to_date = false;            // true if the job was done without baking
  std::optional<BakeReport> report;   // of `reached`, if it was baked here
};

// A BakeEvent says what happened; events come in order. A Bundle event names a complete file. The bundle of a
// preview stays until the queue is destroyed, or until the job is added again and reaches that level again,
// which replaces it.
struct BakeEvent {
  enum class Kind : std::uint8_t {
    Began,   // the job was started, or restarted
    Bundle,  // `bundle` of `preview_level` is complete
    Failed,  // see JobState::error; complete bundles stay
    Cancelled
  };
  Kind kind = Kind::Began;
  JobId job;
  PreviewLevel preview_level = PreviewLevel::Final;
  std::filesystem::path bundle;
};

}  // namespace lambent::baker
