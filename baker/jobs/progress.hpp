// Records how far a long job is. The job names its stages and counts units done, from any thread; whoever
// shows it (a terminal line, the editor's bar) takes snapshots. A Progress also remembers how long each stage
// took, for `--json` and the benchmarks. A job that goes through the same stages more than once, as a bake
// does for each group, says when the next part of it begins.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace lambent::baker {

class Progress {
 public:
  struct Stage {
    std::string name = {};
    std::string unit = {};    // "rays", "samples"; empty if there is nothing to count
    std::uint64_t total = 0;  // in units; 0 if unknown
    std::uint64_t done = 0;
    double seconds = 0.0;
    std::size_t part = 0;           // of the job
    bool found = false;             // results were found in the cache, so its seconds say little
    std::uint64_t found_units = 0;  // of those done, if they were counted
  };

  // Ends the running stage, if any. The stages that follow belong to the next part.
  void beginPart();
  // Ends the running stage, if any, and starts this one.
  void begin(std::string name, std::uint64_t total = 0, std::string unit = {});
  // Sets the total of the running stage, which learns it as it goes. It is never less than what is done.
  void expect(std::uint64_t total);
  void add(std::uint64_t units) { done_.fetch_add(units, std::memory_order_relaxed); }
  // Says that results of the running stage were found, and adds their units.
  void found(std::uint64_t units = 0);
  void end();

  // Returns the running stage; with an empty name if none runs, but of the part that does.
  Stage now() const;
  // Returns the finished stages, in order.
  std::vector<Stage> finished() const;

 private:
  using Clock = std::chrono::steady_clock;
  Stage current() const;  // must be called with the lock held

  mutable std::mutex lock_;
  Stage running_;
  Clock::time_point began_;
  std::vector<Stage> finished_;
  std::size_t part_ = 0;
  std::atomic<std::uint64_t> done_ = 0;
};

}  // namespace lambent::baker
