// A window with an OpenGL 4.5 core context, and what the user does to it since the last look. The only place
// that knows GLFW. Sizes are framebuffer pixels, pointer moves are fractions of the window's height. Errors:
// no display, no OpenGL 4.5 there.
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

// What happened since the last poll.
struct Input {
  float drag_x = 0.0f, drag_y = 0.0f;          // left button held; right and down are positive
  float light_x = 0.0f, light_y = 0.0f;        // the same with the right button
  float scroll = 0.0f;                         // notches; away from the user is positive
  bool reset = false;                          // R
  bool pause = false;                          // space
  int turn = 0;                                // A: -1, D: +1, while held
  bool quit = false;                           // Esc, or the window is being closed
  std::vector<std::filesystem::path> dropped;  // files and folders let fall onto the window
};

class Window {
 public:
  static Result<Window> create(const std::string& title, std::uint32_t width, std::uint32_t height,
                               const ContextOptions& options);

  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  const Context& context() const;
  // For a user interface that listens by itself; valid as long as the window.
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
