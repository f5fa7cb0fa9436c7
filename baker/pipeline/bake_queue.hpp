// Bakes what it is asked for, one piece after another, on a worker thread of its own: every job first
// unshadowed, then coarse, then final (preview_levels.hpp), so that all that was asked for appears before any
// of it gets good. Among jobs at the same preview_level the one asked for last comes first; a job that
// arrives while a final bake runs goes before it (which costs nothing where a cache keeps what it had done).
// PreviewLevels before the final one are written into the work folder, only the final one under its own name;
// they are left out where the final one is up to date or comes within a second (QueueSettings::trial).
//
// All calls are safe from any thread and return at once; none throws. What goes wrong with a job is its
// state. Destruction stops the worker within about a second; what was kept in the cache is found by the next
// bake of the same scene, and the journal (journal.hpp) says which bakes were cut short.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include "baker/cache/cache.hpp"
#include "baker/pipeline/job_state.hpp"

namespace lambent::baker {

struct QueueSettings {
  std::filesystem::path work_folder;  // for previews and the journal; empty: neither
  Cache* cache = nullptr;             // outlives the queue; null: nothing is kept
  bool previews = true;               // preview_levels before the final one
  // That a final bake may take before a coarser one is shown in its place: with everything in the cache it is
  // done by then.
  std::chrono::milliseconds trial{1000};
};

class BakeQueue {
 public:
  explicit BakeQueue(QueueSettings settings);
  ~BakeQueue();
  BakeQueue(const BakeQueue&) = delete;
  BakeQueue& operator=(const BakeQueue&) = delete;

  // The same scene and output again: the job starts anew with what the files hold now, under the same id.
  JobId add(BakeRequest request);
  // What is whole stays. A job that is not there, or is done: nothing happens.
  void cancel(JobId job);

  // In the order in which jobs were first added.
  std::vector<JobState> states() const;
  std::vector<BakeEvent> takeEvents();
  // Whether any job waits or is worked at.
  bool busy() const;
  // Returns when there are events to take or after `time`.
  void waitForEvents(std::chrono::milliseconds time);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lambent::baker
