// Measures what each setting of the frame costs in time and in error in the present view, when asked for: one
// setting a frame, so that the editor stays alive between. Main thread; update() needs a current OpenGL
// context, and the renderer calls it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/frame/setting_cost.hpp"

namespace lambent::editor {

class Session;

class SettingStudy {
 public:
  // Begins to measure every setting at the value that it has.
  void measureAll();
  // Begins to measure one setting at values from its coarsest to its finest.
  void sweep(std::string name);
  // Measures one setting if all is at rest; call it once a frame.
  void update(Session& session);
  bool busy() const { return !waiting_.empty(); }

  struct Row {
    frame::SettingCost cost;
    std::vector<frame::SettingPoint> sweep;  // by rising value; empty: not asked for
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
