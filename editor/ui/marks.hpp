// Records the names and rectangles of widgets, for scripts. A widget that a script may use leaves a mark with
// a name ("inspector.Lamp.strength"). The script clicks and drags at marks, so its input takes the same way
// through Dear ImGui as a user's. It needs a Dear ImGui context and no window. Main thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

namespace lambent::editor {

struct Rectangle {
  glm::vec2 min{0.0f}, max{0.0f};  // in window pixels
  bool shown = true;  // false where the middle of a widget lies outside what its panel shows of its content
  glm::vec2 center() const { return 0.5f * (min + max); }
};

class Marks {
 public:
  // Ends the marks of one frame and begins those of the next.
  void beginFrame();
  // Marks the last widget, or a rectangle, with this name for this frame. If several have the same name, the
  // first keeps it, and the others become NAME#2, NAME#3, ... in drawing order.
  void put(std::string_view name);
  void put(std::string_view name, const Rectangle& where);

  // Both return marks of the last complete frame.
  std::optional<Rectangle> find(std::string_view name) const;
  std::vector<std::string> names() const;

 private:
  std::map<std::string, Rectangle, std::less<>> now_, before_;
  std::map<std::string, std::uint32_t, std::less<>> times_;  // how often a name was used in this frame
};

}  // namespace lambent::editor
