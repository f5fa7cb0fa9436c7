// Runs Dear ImGui in a gpu::Window: its context, its style, its frames, the marks of its widgets, and input
// from scripts. It also collects files that were dropped onto the window. Main thread only. Except for the
// panels, only this room uses Dear ImGui.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "editor/ui/marks.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::editor {

// A ScriptedInput is a script's input for one frame. The user's input is used for whatever it leaves unset.
struct ScriptedInput {
  std::optional<glm::vec2> pointer;  // in window pixels
  bool left = false, right = false, middle = false;
  bool again = false;  // the second press of a double-click, however slowly frames follow each other
  bool ctrl = false, shift = false, alt = false;
  int key = -1;      // a GLFW key code, pressed in this frame
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

  // Waits up to most_s seconds for input or another event of the window. Returns whether one came.
  bool wait(double most_s);
  void begin(const ScriptedInput* scripted);
  void end();

  bool closeRequested() const;
  void refuseClose();
  std::vector<std::filesystem::path> takeDropped();
  void drop(std::filesystem::path file);

  Marks& marks() { return marks_; }
  const Marks& marks() const { return marks_; }

  double sinceInput() const;
  // Returns whether a text field is open, whose cursor blinks.
  bool typing() const;
  // Requests a picture of the window as the next end() draws it. takePicture() then returns it, with row 0 at
  // the top.
  void askForPicture();
  std::optional<spec::Rgba8Image> takePicture();

  struct State;

 private:
  gpu::Window& window_;
  Marks marks_;
  std::unique_ptr<State> state_;
};

// Styles the current Dear ImGui context. scale: a factor on the size of text and widgets.
void setLooks(float scale);

}  // namespace lambent::editor
