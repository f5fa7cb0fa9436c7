// The room gpu owns OpenGL contexts, objects, programs, memory, uploads, work lists and timers. All of it is
// used on the thread that created the context. Missing devices and shaders that do not compile are returned
// as an Error.
//
// This header owns an OpenGL 4.5 core context, which is current on the thread that created it. A headless
// context comes from EGL without a display; a Window has one on a display. Every GL object must be
// destroyed before the context. Errors in debug output (KHR_debug) are counted if requested, and always in
// debug builds; performance hints and notifications are ignored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

struct GLFWwindow;

namespace lambent::gpu {

#ifdef NDEBUG
inline constexpr bool kDebugByDefault = false;
#else
inline constexpr bool kDebugByDefault = true;
#endif

struct ContextOptions {
  // Enables synchronous debug output, which is slower and reports every error at the call that caused it.
  bool debug = kDebugByDefault;
};

struct DeviceInfo {
  std::string renderer, version;
  std::uint32_t max_texture_side = 0;
};

// Fails if the current context is lost, as after a reset of its GPU: nothing is drawn any more, and what was
// read back since is nothing. A context tells it if it was made to: all do that this room makes, where the
// driver can.
Result<void> checkContext();

class Context {
 public:
  // Fails if there is no EGL, or no device with OpenGL 4.5 core whose limits suffice.
  static Result<Context> createHeadless(const ContextOptions& options = {});
  // Refers to the context that is current on this thread, without owning it.
  static Result<Context> attachToCurrent(const ContextOptions& options);

  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;
  ~Context();

  const DeviceInfo& info() const;
  // Returns the number of GL errors so far, from debug output if it is enabled, else from glGetError, whose
  // queue this call empties.
  std::uint64_t errors() const;
  // Returns the first few messages of these errors, for reports.
  const std::vector<std::string>& errorMessages() const;

 private:
  struct State;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

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

// A Window has an OpenGL 4.5 core context and collects the user's input. Only window.cpp uses
// GLFW. Sizes are in framebuffer pixels; pointer motion is in fractions of the window's height.
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
