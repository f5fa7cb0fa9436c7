// Measures what each quality (frame/quality.hpp) costs in time and in error in the present view, when asked
// for: one quality a frame, the highest first, so that the editor stays alive between. The error is the
// relative RMS of linear radiance against the picture at high quality, which has errors of its own: the
// reference beside tells these. Main thread; update() needs a
// current OpenGL context, and the renderer calls it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/measured_frame.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::editor {

class Session;

class QualityStudy {
 public:
  // Begins to measure, with the view, the light and the settings that there are at the next update.
  void measure();
  // Measures one quality if all is at rest; call it once a frame.
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  struct Row {
    std::string quality;
    double error = 0.0;  // against the highest: 0 there
    frame::FrameCost cost;
  };
  // What is measured so far, from the lowest quality to the highest.
  const std::vector<Row>& rows() const { return rows_; }
  // The size of the pictures: the view's, or smaller where that is large.
  const spec::Size& size() const { return size_; }
  const spec::View& view() const { return view_; }

 private:
  std::vector<std::string> waiting_;  // the next last
  std::vector<Row> rows_;
  spec::RgbaImage highest_;
  spec::Size size_{};
  spec::View view_;
};

}  // namespace lambent::editor
