// Refines a reference picture in the background, for a view beside the runtime's. A scene and a request as
// for render() come in. Snapshots go out, first of coarse pictures, then after every pass. A snapshot with N
// samples per pixel has the bits of render() with options.spp = N, for every N at which a pass ends and for
// options.spp itself. The work runs on its own thread and on TBB, and yields to other parallel loops of the
// program. Any change restarts the picture: new lights and views at once, a new scene after it was built in
// the background; unchanged parts are kept. Call it from one thread. Only the destructor waits, for a few
// pixels or for the scene being built.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/jobs/progress.hpp"
#include "reference/reference.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker::reference {

// A Snapshot is the picture so far, always at the requested size.
struct Snapshot {
  std::uint64_t generation = 0;  // number of the restart() that it belongs to
  spec::RgbaImage image;         // mean radiance and coverage, as from render()
  // Means over every other sample, with independent noise, as two references for comparePictures(). They are
  // empty for coarse pictures and for one sample.
  spec::RgbaImage halves[2];
  std::uint32_t spp = 0;         // samples per pixel; 0 in coarse pictures
  std::uint32_t coarseness = 1;  // edge length in pixels of the blocks traced as one; 1 if nothing is coarse
  double seconds = 0.0;          // working time since the restart
  std::optional<double> noise;  // standard error of the pixels, relative to the picture (Film::standardError)
  std::vector<std::string> notices;  // what was repaired or left out, one sentence each
};

enum class ProgressivePhase {
  Preparing,  // loading lights and building the scene's ray-tracing hierarchy
  Tracing,
  Finished,  // options.spp samples are done
  Failed,
};

struct ProgressiveStatus {
  std::uint64_t generation = 0;
  ProgressivePhase phase = ProgressivePhase::Preparing;
  std::optional<Error> error = {};  // what failed: an environment map, a texture, a camera, options, memory
  double share = 0.0;               // fraction done of the current pass or coarse picture
};

class ProgressiveReference {
 public:
  // Stops at options.spp samples (never, if that is kMaxSpp); options.threads is as for inBackground(). The
  // scene must not change; to edit it, pass a changed copy to restart().
  ProgressiveReference(std::shared_ptr<const Scene> scene, Request request);
  // Stops the work.
  ~ProgressiveReference();

  // Starts again with other lights, view, size or options, and returns the new generation. Snapshots of the
  // previous generation stay until the first of the new one. Environment maps are loaded again only if the
  // lights' words changed.
  std::uint64_t restart(Request request);
  std::uint64_t restart(std::shared_ptr<const Scene> scene, Request request);

  // Returns the newest snapshot, or null before the first coarse picture. Does not wait.
  std::shared_ptr<const Snapshot> snapshot() const;
  ProgressiveStatus status() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

// Enlarges a small picture by bilinear interpolation between pixel centres, for previews. The result has no
// depths, because they cannot be interpolated across edges.

spec::RgbaImage enlarged(const spec::RgbaImage& image, const spec::Size& size);

}  // namespace lambent::baker::reference
