// Dear ImGui over a gpu::Window: its context, its looks, a frame of it, and input that comes from a script as
// if it came from the user. Widgets that scripts may want to reach leave a mark with a name ("inspector.Lamp.
// strength"); a script clicks and drags at marks, so it takes the same way through Dear ImGui as a hand
// would. Main thread only. The one room beside panels/ that knows Dear ImGui; files that were dropped onto
// the window are handed on.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "runtime/gpu/window.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

// What a script holds down and types in this frame; what it does not say is the user's.
struct ScriptedInput {
  std::optional<glm::vec2> pointer;  // window pixels
  bool left = false, right = false, middle = false;
  bool ctrl = false, shift = false, alt = false;
  int key = -1;      // of GLFW, pressed in this frame
  std::string text;  // typed in this frame
  float wheel = 0.0f;
};

struct Rectangle {
  glm::vec2 min{0.0f}, max{0.0f};  // window pixels
  glm::vec2 center() const { return 0.5f * (min + max); }
};

class Ui {
 public:
  // scale: of text and widgets.
  explicit Ui(gpu::Window& window, float scale = 1.0f);
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  // Waits up to wait_s for something to happen, then begins a frame.
  void begin(double wait_s, const ScriptedInput* scripted);
  // Draws it into framebuffer 0.
  void end();

  bool closeRequested() const;
  void refuseClose();
  std::vector<std::filesystem::path> takeDropped();
  // As if dropped onto the window.
  void drop(std::filesystem::path file);

  // Of the last widget, under this name until it is not drawn any more. Of several with one name, the first
  // has it, the others are NAME#2, NAME#3, ... in the order in which they are drawn.
  void mark(std::string_view name);
  void mark(std::string_view name, const Rectangle& where);
  // Of the last whole frame.
  std::optional<Rectangle> find(std::string_view name) const;
  std::vector<std::string> marks() const;

  // In seconds, of the user or a script.
  double sinceInput() const;
  // The window as the next end() draws it: asked for in one frame, there in the next. Row 0 at the top.
  void askForPicture();
  std::optional<spec::Rgba8Image> takePicture();

  struct State;

 private:
  gpu::Window& window_;
  std::unique_ptr<State> state_;
};

}  // namespace lambent::editor
