// How long each pass of a frame takes, on the CPU and on the GPU. A pass is a scope; GPU times are timestamp
// queries kept in a ring and read when they are there, a few frames later, so that asking never makes the CPU
// wait. Also counts what each pass issued, and says why it had anything to do. Times in milliseconds.
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

struct PassTime {
  std::string name;
  double cpu_ms = 0.0;
  double gpu_ms = -1.0;  // -1: not known
  Counters counters;
  std::string reason{};  // what changed; empty: nothing, the pass was up to date
};

class PassTimers {
 public:
  // Times what is issued until it dies; also a debug group of that name.
  class Scope {
   public:
    Scope(PassTimers& timers, std::string_view name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    Counters& counters();
    void because(std::string reason);

   private:
    PassTimers& timers_;
    DebugGroup group_;
    std::size_t pass_;
    std::chrono::steady_clock::time_point start_;
  };

  void beginFrame();
  // Waits for all frames in flight, so that latest() is the last one: for headless reports.
  void finish();
  // The newest frame whose times are all known, in the order of its passes.
  const std::vector<PassTime>& latest() const { return latest_; }

 private:
  struct QueryTraits {
    static void destroy(GLuint id) { glDeleteQueries(1, &id); }
  };
  struct Frame {
    std::vector<PassTime> passes;
    std::vector<Handle<QueryTraits>> queries;  // two per pass, kept and used again
  };
  void collect(Frame& frame, bool wait);

  static constexpr std::size_t kFramesInFlight = 4;
  std::array<Frame, kFramesInFlight> frames_;
  std::size_t current_ = 0;
  std::vector<PassTime> latest_;
};

}  // namespace lambent::gpu
