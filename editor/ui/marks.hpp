// Keeps the names of widgets on the screen, for scripts. A widget that a script may want to reach leaves a
// mark with a name ("inspector.Lamp.strength"); the script clicks and drags at marks, so it takes the same
// way through Dear ImGui as a hand would. Needs a Dear ImGui context and no window. Main thread.
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
  glm::vec2 min{0.0f}, max{0.0f};  // window pixels
  glm::vec2 center() const { return 0.5f * (min + max); }
};

class Marks {
 public:
  // Ends one frame's marks and begins those of the next.
  void beginFrame();
  // Marks the last widget, or a place, with this name for as long as it is drawn. Of several with one name,
  // the first has it, and the others are NAME#2, NAME#3, ... in the order in which they are drawn.
  void put(std::string_view name);
  void put(std::string_view name, const Rectangle& where);

  // Both tell of the last whole frame.
  std::optional<Rectangle> find(std::string_view name) const;
  std::vector<std::string> names() const;

 private:
  std::map<std::string, Rectangle, std::less<>> now_, before_;
  std::map<std::string, std::uint32_t, std::less<>> times_;  // how often a name was given in this frame
};

}  // namespace lambent::editor
