// Measures the CPU and GPU time of each pass of a frame, in milliseconds. A pass is a scope. GPU times are
// timestamp queries in a ring, which are read a few frames later when they are available, so the CPU never
// waits. The timers also record the commands of each pass and why it had work to do.
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/gpu/objects.hpp"

namespace lambent::gpu {

struct PassTime {
  std::string name;
  double cpu_ms = 0.0;
  double gpu_ms = -1.0;  // -1 if unknown
  Counters counters;
  std::string reason{};  // the change that caused work; empty if the pass was up to date
};

class PassTimers {
  struct QueryTraits {
    static void destroy(GLuint id) { glDeleteQueries(1, &id); }
  };
  struct Frame {
    std::vector<PassTime> passes;
    std::vector<Handle<QueryTraits>> queries;  // two per pass, reused in later frames
  };

 public:
  // Times the commands of its lifetime, which also form a debug group of this name.
  class Scope {
   public:
    Scope(PassTimers& timers, std::string_view name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    Counters& counters() { return frame_.passes[pass_].counters; }
    void because(std::string reason) { frame_.passes[pass_].reason = std::move(reason); }

   private:
    Frame& frame_;
    DebugGroup group_;
    std::size_t pass_;
    std::chrono::steady_clock::time_point start_;
  };

  void beginFrame();
  // Waits for all frames in flight, so that latest() is the last frame. Headless reports need this.
  void finish();
  // Returns the times of the newest frame that are all known, in the order of its passes.
  const std::vector<PassTime>& latest() const { return latest_; }

 private:
  void collect(Frame& frame, bool wait);

  static constexpr std::size_t kFramesInFlight = 4;
  std::array<Frame, kFramesInFlight> frames_;
  std::size_t current_ = 0;
  std::vector<PassTime> latest_;
};

}  // namespace lambent::gpu
