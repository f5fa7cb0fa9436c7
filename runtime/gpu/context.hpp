// An OpenGL 4.5 core context and what it says about itself. Headless ones come from EGL without any display;
// a window's comes from window.hpp, which is the only place that knows GLFW. Owns the context and makes it
// current on the thread that created it; every GL object must die before it does. Debug output (KHR_debug) is
// collected into an error count when asked for, and always in debug builds; performance hints and notices are
// left out. Errors: no EGL, no device that gives OpenGL 4.5 core.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "runtime/base/result.hpp"

namespace lambent::gpu {

#ifdef NDEBUG
inline constexpr bool kDebugByDefault = false;
#else
inline constexpr bool kDebugByDefault = true;
#endif

struct ContextOptions {
  bool debug =
      kDebugByDefault;  // synchronous debug output: slower, and every error is counted where it happens
};

struct DeviceInfo {
  std::string renderer, vendor, version;
  std::uint64_t max_storage_bytes = 0;  // of one shader storage block
  std::uint32_t max_vertex_storage_blocks = 0;
  std::uint32_t max_samples = 0;
  std::uint32_t max_texture_side = 0;
};

class Context {
 public:
  static Result<Context> createHeadless(const ContextOptions& options = {});
  // Takes note of the context that is current on this thread; whoever made it keeps it.
  static Result<Context> attachToCurrent(const ContextOptions& options);

  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;
  ~Context();

  const DeviceInfo& info() const;
  // GL errors so far: from debug output where it is on, else from glGetError, which is drained here.
  std::uint64_t errors() const;
  // The first few messages behind errors(), for a test's or a program's report.
  const std::vector<std::string>& errorMessages() const;

 private:
  struct State;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lambent::gpu
