// A reference picture that refines while somebody looks on, for a view beside the runtime's. Comes in: a
// scene, and the request that `lambent reference` would have. Goes out: snapshots, of coarse pictures at
// first, then of whole ones, pass by pass; at N samples a pixel they have the bits of render() with
// options.spp = N, for any N where its passes end and for options.spp itself. All work is done on a thread of
// its own and on TBB beside it, which give way to other parallel loops of the program. Any change begins the
// picture anew: of lights and view at once, of the scene after it was built in the background; what did not
// change is kept. Call it from one thread; nothing here waits but the destructor, for a few pixels or for the
// scene in hand.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/jobs/progress.hpp"
#include "reference/reference.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker::reference {

// A picture so far, always of the size that was asked for.
struct Snapshot {
  std::uint64_t generation = 0;  // of the restart() that it belongs to
  spec::RgbaImage image;         // mean radiance and coverage, as render() has it
  // Means over every other sample, with independent noise: two references for comparePictures(). Empty in
  // coarse pictures, and with one sample.
  spec::RgbaImage halves[2];
  std::uint32_t spp = 0;         // that all pixels have; 0: coarse
  std::uint32_t coarseness = 1;  // pixels along an edge of what was traced for one; 1 where nothing is coarse
  double seconds = 0.0;          // of work since the restart
  std::optional<double> noise;  // standard error of the pixels, relative to the picture (Film::standardError)
  std::vector<std::string> notices;  // what was repaired or put aside, a sentence each
};

enum class ProgressivePhase {
  Preparing,  // reads lights, builds the scene's hierarchy
  Tracing,
  Finished,  // has options.spp
  Failed,
};

struct ProgressiveStatus {
  std::uint64_t generation = 0;
  ProgressivePhase phase = ProgressivePhase::Preparing;
  bool paused = false;
  std::optional<Error> error = {};  // where it failed: a probe, a texture, a camera, options, memory
  double share = 0.0;               // of the pass that runs, or of the coarse picture
};

class ProgressiveReference {
 public:
  // options.spp is where it ends (kMaxSpp: never); options.threads as inBackground() takes it. The scene must
  // not change any more: whoever edits hands on a changed copy.
  ProgressiveReference(std::shared_ptr<const Scene> scene, Request request);
  // Stops.
  ~ProgressiveReference();

  // Other lights, view, size, options. Returns the new generation; snapshots of the one before stay until the
  // first of this. Probes are read again only where the lights' words changed.
  std::uint64_t restart(Request request);
  std::uint64_t restart(std::shared_ptr<const Scene> scene, Request request);

  // Holds still, with all that is done, until it may go on. A restart does not end it.
  void pause(bool paused);

  // The newest; none before the first coarse picture. Costs nothing.
  std::shared_ptr<const Snapshot> snapshot() const;
  ProgressiveStatus status() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace lambent::baker::reference
