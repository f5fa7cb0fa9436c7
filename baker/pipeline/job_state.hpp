// What a user interface shows of a bake: snapshots of jobs, and events. Values only; BakeQueue hands them
// out.
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
  std::optional<PreviewLevel> preview_level;  // that it works at, or will work at next
  std::optional<PreviewLevel> reached;        // the best that is whole, of the content that was added last
  std::filesystem::path bundle;               // of `reached`: what to show; empty before

  Progress::Stage stage;               // that runs now; no name: none
  double units_per_s = 0.0;            // of the stage
  double seconds = 0.0;                // worked at it so far, all preview_levels
  double fraction = 0.0;               // of the whole job, 0..1; never falls unless the job starts anew
  std::optional<double> seconds_left;  // of the whole job; nothing while nobody can tell

  std::optional<Error> error;         // of a job that failed
  std::vector<std::string> warnings;  // of the import, then the bake's notices
  bool up_to_date = false;            // done without baking
  std::optional<BakeReport> report;   // of `reached`, where it was baked here
};

// What happened, in order. A bundle event names a file that is whole. A bundle of a preview_level before the
// final one stays until the queue goes, or until the job, added again, reaches that preview_level again and
// replaces it.
struct BakeEvent {
  enum class Kind : std::uint8_t {
    Began,   // took the job up, for the first time or anew
    Bundle,  // `bundle` of `preview_level` is whole
    Failed,  // with JobState::error; what was whole stays
    Cancelled
  };
  Kind kind = Kind::Began;
  JobId job;
  PreviewLevel preview_level = PreviewLevel::Final;
  std::filesystem::path bundle;
};

}  // namespace lambent::baker
