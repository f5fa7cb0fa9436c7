// What each knob of the frame costs in time and in error in the present view, measured when asked for: one
// knob a frame, so that the editor stays alive between. Main thread, with a current OpenGL context.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/frame/knob_cost.hpp"

namespace lambent::editor {

class Session;

class KnobStudy {
 public:
  // Of every knob at the value that it has.
  void measureAll();
  // Over values from the coarsest to the finest of one knob.
  void sweep(std::string name);
  // Once a frame.
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  struct Row {
    frame::KnobCost cost;
    std::vector<frame::KnobPoint> sweep;  // by rising value; empty: not asked for
  };
  const std::map<std::string, Row, std::less<>>& rows() const { return rows_; }

 private:
  struct Task {
    std::string name;
    bool sweep = false;
  };
  std::vector<Task> waiting_;  // the next last
  std::map<std::string, Row, std::less<>> rows_;
};

}  // namespace lambent::editor
