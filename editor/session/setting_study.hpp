// Measures on request what each setting of the frame costs in time and in error in the present view. It
// measures one setting a frame, so that the editor stays responsive. Main thread; update() needs a current
// OpenGL context, and the renderer calls it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/measure/measured_frame.hpp"

namespace lambent::editor {

class Session;

class SettingStudy {
 public:
  // Starts measuring every setting at its present value.
  void measureAll();
  // Starts measuring one setting at values from its coarsest to its finest.
  void sweep(std::string name);
  // Measures one setting if everything is loaded and at rest. Call it once a frame.
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  struct Row {
    frame::SettingCost cost;
    std::vector<frame::SettingPoint> sweep;  // by increasing value; empty: not requested
  };
  const std::map<std::string, Row, std::less<>>& rows() const { return rows_; }

 private:
  struct Task {
    std::string name;
    bool sweep = false;
  };
  std::vector<Task> waiting_;  // the last is the next
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace lambent::editor
