// Runs Dear ImGui over a gpu::Window: its context, its looks, a frame of it, the marks of its widgets, and
// input that comes from a script as if it came from the user. Files that were dropped onto the window are
// handed on. Main thread only. Beside the panels, this is the only room that knows Dear ImGui.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "editor/ui/marks.hpp"
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

class Ui {
 public:
  // scale: factor on the size of text and widgets.
  explicit Ui(gpu::Window& window, float scale = 1.0f);
  ~Ui();
  Ui(const Ui&) = delete;
  Ui& operator=(const Ui&) = delete;

  // Waits up to wait_s for something to happen, then begins a frame.
  void begin(double wait_s, const ScriptedInput* scripted);
  // Draws the frame into framebuffer 0.
  void end();

  bool closeRequested() const;
  void refuseClose();
  std::vector<std::filesystem::path> takeDropped();
  // Takes the file as if it were dropped onto the window.
  void drop(std::filesystem::path file);

  Marks& marks() { return marks_; }
  const Marks& marks() const { return marks_; }

  // Returns how many seconds ago the user or a script did anything.
  double sinceInput() const;
  // Asks for the window as the next end() draws it; takePicture() has it then, with row 0 at the top.
  void askForPicture();
  std::optional<spec::Rgba8Image> takePicture();

  struct State;

 private:
  gpu::Window& window_;
  Marks marks_;
  std::unique_ptr<State> state_;
};

}  // namespace lambent::editor
