// Does all OpenGL work of the editor except its widgets: the runtime's picture, the reference's,
// and the studies of what settings cost, one step a frame. It reads the session and writes its results
// there. Main thread; it must not outlive the window's OpenGL context. Errors: no OpenGL 4.5.
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

#include "editor/session/session.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/tone_map/tone_mapper.hpp"

namespace lambent::editor {

// Renders the runtime's picture of the world from the editor's camera, whenever something that it shows has
// changed. The session comes in; a texture goes out, and PictureFacts for commands and panels. Only pick()
// waits for the GPU: times, exposure and negative pixels are read once a picture is finished. Main thread,
// with a current OpenGL context. Errors: no OpenGL 4.5; later errors are logged.

// Measures how long the GPU and the CPU take for pictures, without waiting for either: it puts timestamp
// queries around each picture and reads them in a later frame, once they are available. It also tells
// whether the GPU still works on a picture.
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

class Picture {
 public:
  static Result<Picture> create(const Session& session);

  // Renders at this size if anything has changed. Call it once a frame.
  void update(Session& session, spec::Size size);
  // Returns what is visible at a pixel of the last picture, counted from the top left corner, or none for the
  // sky. Waits for the GPU.
  Result<std::optional<frame::Picked>> pick(Session& session, float x, float y);
  // Row 0 of the texture is the bottom.
  const gpu::Texture& texture() const { return frame_.picture(); }

 private:
  explicit Picture(frame::Frame frame) : frame_(std::move(frame)) {}
  Result<void> draw(Session& session, const spec::View& view, spec::Size size);
  void readFinished(Session& session);

  frame::Frame frame_;
  PictureClock clock_;
  // Identifies what the last picture showed.
  struct Drawn {
    std::uint64_t edits = 0;  // sum of the versions of history and selection
    spec::View view;
    spec::Size size;
  };
  Drawn drawn_;
  bool unread_ = false;  // exposure and negative pixels of the last picture are still to be read
};

// Shows the path-traced reference: its newest snapshot with the exposure of the runtime's picture, or a heat
// map of its difference from a linear picture that the runtime renders for the same view. Error figures go
// to the session's ReferenceView. A comparison waits for the GPU, once for each snapshot. Errors are logged.
class ReferencePicture {
 public:
  // Follows the session's reference. Call it once a frame, after the runtime's picture was rendered.
  void update(Session& session);
  // Returns the texture to show, row 0 at the top. It has no handle while there is nothing to show.
  const gpu::Texture& texture(SplitView split) const { return split == SplitView::Heat ? heat_ : shown_; }

 private:
  Result<void> show(Session& session, const baker::reference::Snapshot& snapshot);
  Result<void> compare(Session& session, const baker::reference::Snapshot& snapshot);
  Result<spec::RgbaImage> linearPicture(Session& session, spec::Size size);

  std::optional<frame::ToneMapper> tone_mapper_;
  std::optional<frame::Frame> linear_;
  gpu::Texture radiance_, shown_, heat_;
  gpu::Framebuffer shown_target_;
  float exposure_ev_ = 0.0f;  // of shown_
};

class Renderer {
 public:
  static Result<Renderer> create(const Session& session);

  // Renders the view at this size if anything changed, and does all other pending work. Call it once a frame.
  void update(Session& session, spec::Size size);

  Picture picture;
  ReferencePicture reference{};
};

}  // namespace lambent::editor
