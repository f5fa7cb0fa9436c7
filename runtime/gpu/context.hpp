// The room gpu owns OpenGL contexts, objects, programs, memory, uploads, work lists and timers. All of it is
// used on the thread that created the context. Missing devices and shaders that do not compile are returned
// as an Error.
//
// This header owns an OpenGL 4.5 core context, which is current on the thread that created it. A headless
// context comes from EGL without a display; window.hpp makes that of a window. Every GL object must be
// destroyed before the context. Errors in debug output (KHR_debug) are counted if requested, and always in
// debug builds; performance hints and notifications are ignored.
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
  // Enables synchronous debug output, which is slower and reports every error at the call that caused it.
  bool debug = kDebugByDefault;
};

struct DeviceInfo {
  std::string renderer, version;
  std::uint64_t max_storage_bytes = 0;  // size limit of a shader storage block
  std::uint32_t max_vertex_storage_blocks = 0;
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

}  // namespace lambent::gpu
