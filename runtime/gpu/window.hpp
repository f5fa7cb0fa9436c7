// A Window has an OpenGL 4.5 core context and collects the user's input. Only this part of the room uses
// GLFW. Sizes are in framebuffer pixels; pointer motion is in fractions of the window's height.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/gpu/context.hpp"

struct GLFWwindow;

namespace lambent::gpu {

// Holds the input since the last poll.
struct Input {
  float drag_x = 0.0f, drag_y = 0.0f;          // motion with the left button; right and down are positive
  float light_x = 0.0f, light_y = 0.0f;        // motion with the right button
  float scroll = 0.0f;                         // notches; away from the user is positive
  bool reset = false;                          // the R key was pressed
  bool pause = false;                          // the space bar was pressed
  bool help = false;                           // the H key was pressed
  int turn = 0;                                // -1 while A is held, +1 while D is held
  bool quit = false;                           // Esc was pressed or the window is being closed
  std::vector<std::filesystem::path> dropped;  // files and folders that were dropped onto the window
};

class Window {
 public:
  // Fails if there is no display, or no OpenGL 4.5 core on it.
  static Result<Window> create(const std::string& title, std::uint32_t width, std::uint32_t height,
                               const ContextOptions& options);

  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  // Returns GLFW's handle for user interfaces that handle events themselves. It is valid as long as the
  // window.
  GLFWwindow* handle() const;
  Input poll();
  void framebufferSize(std::uint32_t& width, std::uint32_t& height) const;
  void setTitle(const std::string& title);
  void swap();

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::gpu
