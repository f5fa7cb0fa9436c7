// The room baker/pipeline bakes in the background. The queue takes requests and works on one step at a time,
// on a worker thread of its own: every job first unshadowed, then coarse, then final (preview_levels.hpp), so
// that everything appears before any of it gets good. Among jobs at the same preview level, the latest
// request comes first. A job that arrives while a final bake runs goes before it, which costs nothing if a
// cache keeps the interrupted work. Only the final bundle is written under its own name; previews go into the
// work folder, and are left out if the final bundle is up to date or ready within a second
// (QueueSettings::trial).
//
// All calls are safe from any thread and never throw; all but waitForEvents() return at once. The error of a
// job is part of its state. Destruction stops the worker within about a second; the next bake of the same
// scene then finds what the cache kept, and the journal (journal.hpp) says which bakes were cut short.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include "baker/cache/cache.hpp"
#include "baker/pipeline/job_state.hpp"

namespace lambent::baker {

struct QueueSettings {
  std::filesystem::path work_folder;  // for previews and the journal; if empty, there are neither
  Cache* cache = nullptr;             // must outlive the queue; null: no results are kept
  bool previews = true;               // makes previews before the final bake
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
  // Returns when there are events to take, or after `time`.
  void waitForEvents(std::chrono::milliseconds time);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lambent::baker
