// Measures how long the GPU and the CPU take for pictures without waiting for either: timestamp queries
// around each picture, which are read in a later frame, when they are there. Tells, too, whether a picture is
// still being drawn. Milliseconds. Main thread, with a current OpenGL context.
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
    double milliseconds = 0.0;  // from the first command to the last, or the CPU's if that took longer
    bool whole = true;          // as end() was told
  };

  // Encloses the commands of a picture. whole: at full resolution.
  void begin();
  void end(bool whole);
  // Returns the time of the oldest picture that is finished and was not returned before.
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

  std::deque<Picture> pictures_;  // the oldest first
  std::vector<Query> free_;
  Query first_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace lambent::editor
