// Measures on request what each quality (frame/quality.hpp) costs in time and in error in the present view.
// It measures one quality a frame, the highest first, so that the editor stays responsive. The error is the
// relative RMS of linear radiance against the picture at high quality, whose own errors only the reference
// shows. Main thread; update() needs a current OpenGL context, and the renderer calls it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/measure/measured_frame.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::editor {

class Session;

class QualityStudy {
 public:
  // Starts measuring, with the view, light and settings at the next update().
  void measure();
  // Measures one quality if everything is loaded and at rest. Call it once a frame.
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  struct Row {
    std::string quality;
    double error = 0.0;  // relative to the highest quality, where it is 0
    frame::FrameCost cost;
  };
  // Returns the results so far, from the lowest quality to the highest.
  const std::vector<Row>& rows() const { return rows_; }
  // Returns the size of the measured pictures: the view's, or smaller if the view is large.
  const spec::Size& size() const { return size_; }
  const spec::View& view() const { return view_; }

 private:
  std::vector<std::string> waiting_;  // the last is the next
  std::vector<Row> rows_;
  spec::RgbaImage highest_;
  spec::Size size_{};
  spec::View view_;
};

}  // namespace lambent::editor
