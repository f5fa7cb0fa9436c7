// The room baker/pipeline bakes in the background. The queue takes requests and works on one step at a time,
// on a worker thread of its own: every job first unshadowed, then coarse, then final (PreviewLevel), so
// that everything appears before any of it gets good. Among jobs at the same preview level, the latest
// request comes first. A job that arrives while a final bake runs goes before it, which costs nothing if a
// cache keeps the interrupted work. Only the final bundle is written under its own name; previews go into the
// work folder, and are left out if the final bundle is up to date or ready within a second
// (QueueSettings::trial).
//
// All calls are safe from any thread, never throw and return at once. The error of a job is part of its
// state. Destruction stops the worker within about a second; the next bake of the same scene then finds what
// the cache kept.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/cache/cache.hpp"
#include "baker/import/scene_edits.hpp"
#include "baker/import/scene_files.hpp"

namespace lambent::baker {

// A scene gets better in preview levels: at once unshadowed, then coarse transfer, then what was asked for.
// Each is a complete bundle.
enum class PreviewLevel : std::uint8_t {
  Unshadowed,  // traces no rays (bakeUnshadowed)
  Coarse,      // few rays, one bounce, no refinement; takes seconds
  Final        // the options that were asked for
};

const char* previewLevelName(PreviewLevel preview_level);  // "unshadowed", "coarse", "final"

// Says which scene to bake, into which bundle, and how. Two requests for the same scene and output are the
// same job, whatever else they say.
struct BakeRequest {
  std::filesystem::path scene, output;
  BakeOptions options{};
  ImportOptions import{};
  SceneEdits edits{};                       // applied to the scene before it is baked
  PreviewLevel last = PreviewLevel::Final;  // the job is done at this level
};

// Returns the path made absolute and without "." and "..".
std::filesystem::path plainPath(const std::filesystem::path& path);

// Jobs, their states and events are plain values, for a user interface.
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
  std::vector<std::string> warnings;  // of the import, then the bake's notices
  bool up_to_date = false;            // true if the job was done without baking
  std::optional<BakeReport> report;   // of `reached`, if it was baked here
};

// A BakeEvent says what happened; events come in order. A Bundle event names a complete file. The bundle of a
// preview stays until the queue is destroyed, or until the job is added again and reaches that level again,
// which replaces it.
struct BakeEvent {
  enum class Kind : std::uint8_t {
    Bundle,  // `bundle` of `preview_level` is complete
    Failed,  // see JobState::error; complete bundles stay
    Cancelled
  };
  Kind kind = Kind::Bundle;
  JobId job;
  PreviewLevel preview_level = PreviewLevel::Final;
  std::filesystem::path bundle;
};

struct QueueSettings {
  std::filesystem::path work_folder;  // for previews; if empty, there are none
  Cache* cache = nullptr;             // must outlive the queue; null: no results are kept
  // Time that a final bake gets before a preview is made instead; with everything in the cache it is enough.
  std::chrono::milliseconds trial{1000};
};

class BakeQueue {
 public:
  explicit BakeQueue(QueueSettings settings);
  ~BakeQueue();
  BakeQueue(const BakeQueue&) = delete;
  BakeQueue& operator=(const BakeQueue&) = delete;

  // Adding the same scene and output again restarts the job with the present content of the files, under the
  // same id.
  JobId add(BakeRequest request);
  // Stops a job; bundles that are complete stay. Does nothing if the job does not exist or is done.
  void cancel(JobId job);

  // Returns the jobs in the order in which they were first added.
  std::vector<JobState> states() const;
  std::vector<BakeEvent> takeEvents();
  // Returns whether any job waits or runs.
  bool busy() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lambent::baker
