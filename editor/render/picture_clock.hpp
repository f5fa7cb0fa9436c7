// Measures how long the GPU and the CPU take for pictures, without waiting for either: it puts timestamp
// queries around each picture and reads them in a later frame, once they are available. It also tells whether
// the GPU still works on a picture. Times are in milliseconds. Main thread, with a current OpenGL context.
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

#include "runtime/gpu/objects.hpp"

namespace lambent::editor {

class PictureClock {
 public:
  struct Time {
    // From the first command to the last on the GPU, or the CPU's time if that was longer.
    double milliseconds = 0.0;
    bool whole = true;  // the argument of end()
  };

  // Call these before and after the commands of a picture. whole: it has full resolution.
  void begin();
  void end(bool whole);
  // Returns the time of the oldest finished picture that was not returned before.
  std::optional<Time> take();
  bool inFlight() const { return !pictures_.empty(); }

 private:
  struct QueryTraits {
    static void destroy(GLuint id) { glDeleteQueries(1, &id); }
  };
  using Query = gpu::Handle<QueryTraits>;
  struct Picture {
    Query first, last;
    double cpu_ms = 0.0;
    bool whole = true;
  };
  Query timestamp();

  std::deque<Picture> pictures_;  // oldest first
  std::vector<Query> free_;
  Query first_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace lambent::editor
