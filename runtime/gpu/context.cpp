#include "runtime/gpu/context.hpp"

#include <array>
#include <string_view>
#include <vector>

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include "runtime/gpu/arena.hpp"

namespace lambent::gpu {

namespace {

constexpr std::size_t kMessagesKept = 8;

bool hasExtension(const char* list, std::string_view name) {
  return fmt::format(" {} ", list ? list : "").find(fmt::format(" {} ", name)) != std::string::npos;
}

struct DisplayChoice {
  EGLDisplay display = EGL_NO_DISPLAY;
  const char* platform = "";
};

// Returns displays in the order in which they are tried. Real GPUs come first, because Mesa's surfaceless
// platform would choose its software renderer instead of another vendor's GPU. The surfaceless platform,
// software devices and EGL's default follow.
std::vector<DisplayChoice> displayChoices() {
  std::vector<DisplayChoice> choices, software;
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const bool platforms = hasExtension(client, "EGL_EXT_platform_base");
  if (platforms && hasExtension(client, "EGL_EXT_platform_device") &&
      (hasExtension(client, "EGL_EXT_device_enumeration") || hasExtension(client, "EGL_EXT_device_base"))) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    for (EGLint i = 0; i < count; ++i) {
      const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
      const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
      const DisplayChoice choice{eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr),
                                 "EGL device"};
      (hasExtension(extensions, "EGL_MESA_device_software") ? software : choices).push_back(choice);
    }
  }
  if (platforms && hasExtension(client, "EGL_MESA_platform_surfaceless"))
    choices.push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                       "EGL surfaceless"});
  choices.insert(choices.end(), software.begin(), software.end());
  choices.push_back({eglGetDisplay(EGL_DEFAULT_DISPLAY), "EGL default display"});
  return choices;
}

// A vertex shader reads at most so many storage blocks (runtime/surface/surface.vert).
constexpr GLint kVertexStorageBlocks = 5;

// OpenGL 4.5 leaves storage blocks of vertex shaders optional, and some drivers have none.
Result<void> checkLimits(const std::string& renderer) {
  GLint64 storage = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &storage);
  GLint blocks = 0;
  glGetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &blocks);
  const auto lacks = [&](std::string what) {
    return fail("OpenGL", fmt::format("{} {}", renderer, what), "use another GPU or driver");
  };
  if (blocks < kVertexStorageBlocks)
    return lacks(
        fmt::format("has {} storage blocks in vertex shaders, {} are needed", blocks, kVertexStorageBlocks));
  if (static_cast<std::uint64_t>(storage) < Arena::kMaxPageBytes)
    return lacks(fmt::format("has storage blocks of {} bytes, {} are needed", storage, Arena::kMaxPageBytes));
  return {};
}

// Makes an OpenGL 4.5 core context without a surface on the display and makes it current.
Result<EGLContext> makeCurrent(EGLDisplay display, bool debug) {
  const auto no = [](std::string why) { return fail("OpenGL", std::move(why)); };
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return no("does not start");
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (!hasExtension(extensions, "EGL_KHR_surfaceless_context")) return no("needs a surface");
  if (!eglBindAPI(EGL_OPENGL_API)) return no("has no desktop OpenGL");
  EGLConfig config = nullptr;
  EGLint config_count = 0;
  // No surface is ever made, so the surface type is 0 (any) instead of the default EGL_WINDOW_BIT.
  constexpr std::array<EGLint, 5> kConfig = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                             EGL_NONE};
  if (!eglChooseConfig(display, kConfig.data(), &config, 1, &config_count) || config_count == 0) {
    if (!hasExtension(extensions, "EGL_KHR_no_config_context")) return no("has no OpenGL configuration");
    config = nullptr;
  }
  std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                    4,
                                    EGL_CONTEXT_MINOR_VERSION,
                                    5,
                                    EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                    EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                    EGL_CONTEXT_OPENGL_DEBUG,
                                    debug ? EGL_TRUE : EGL_FALSE,
                                    EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                    EGL_LOSE_CONTEXT_ON_RESET,
                                    EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  if (context == EGL_NO_CONTEXT) {  // some drivers cannot tell of a reset, or are older than EGL 1.5
    attributes.resize(attributes.size() - 3);
    attributes.push_back(EGL_NONE);
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  }
  if (context == EGL_NO_CONTEXT) return no("gives no 4.5 core context");
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    eglDestroyContext(display, context);
    return no("does not make its context current");
  }
  return context;
}

std::string glText(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

}  // namespace

struct Context::State {
  EGLDisplay display = EGL_NO_DISPLAY;  // EGL_NO_DISPLAY if the context is not owned
  EGLContext context = EGL_NO_CONTEXT;
  DeviceInfo info;
  bool debug = false;
  std::uint64_t errors = 0;
  std::vector<std::string> messages;

  void note(std::string message) {
    ++errors;
    if (messages.size() < kMessagesKept) messages.push_back(std::move(message));
  }

  static void GLAPIENTRY onMessage(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length,
                                   const GLchar* message, const void* user) {
    if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
    auto* state = static_cast<State*>(const_cast<void*>(user));
    state->note(std::string(message, static_cast<std::size_t>(length)));
  }

  ~State() {
    if (context == EGL_NO_CONTEXT) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
    // The display is not terminated. A process has one of each kind, and other contexts may use it.
  }
};

Result<void> checkContext() {
  const GLenum reset = glGetGraphicsResetStatus();
  if (reset == GL_NO_ERROR) return {};
  return fail("GPU",
              fmt::format("has lost all that was drawn: its driver reset it{}",
                          reset == GL_GUILTY_CONTEXT_RESET     ? " because of this program"
                          : reset == GL_INNOCENT_CONTEXT_RESET ? " because of another program"
                                                               : ""),
              "start the program again");
}

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;
Context::~Context() = default;

Result<Context> Context::createHeadless(const ContextOptions& options) {
  std::string tried;
  for (const DisplayChoice& choice : displayChoices()) {
    const Result<EGLContext> context = makeCurrent(choice.display, options.debug);
    if (!context) {
      tried += fmt::format("{}{} {}", tried.empty() ? "" : ", ", choice.platform, context.error().problem);
      continue;
    }
    Result<Context> attached = attachToCurrent(options);
    if (!attached) {
      eglMakeCurrent(choice.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(choice.display, *context);
      tried += fmt::format("{}{}: {}", tried.empty() ? "" : ", ", choice.platform, attached.error().problem);
      continue;
    }
    attached->state_->display = choice.display;
    attached->state_->context = *context;
    return attached;
  }
  return fail("OpenGL", fmt::format("no device gives OpenGL 4.5 core without a display ({})", tried),
              "install a driver, or Mesa's software renderer (libgl1-mesa-dri, libegl1)");
}

Result<Context> Context::attachToCurrent(const ContextOptions& options) {
  const int version = epoxy_gl_version();
  if (version == 0)
    return fail("OpenGL", "no context is current on this thread", "make one of OpenGL 4.5 current");
  if (version < 45)
    return fail("OpenGL",
                fmt::format("{} offers OpenGL {}, 4.5 is needed", glText(GL_RENDERER), glText(GL_VERSION)),
                "update the driver");
  auto state = std::make_unique<State>();
  state->debug = options.debug;
  GLint side = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
  state->info = {.renderer = glText(GL_RENDERER),
                 .version = glText(GL_VERSION),
                 .max_texture_side = static_cast<std::uint32_t>(side)};
  if (auto enough = checkLimits(state->info.renderer); !enough) return failAgain(enough.error());
  if (options.debug) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(&State::onMessage, state.get());
  }
  return Context(std::move(state));
}

const DeviceInfo& Context::info() const {
  return state_->info;
}

std::uint64_t Context::errors() const {
  if (!state_->debug)
    while (const GLenum error = glGetError()) state_->note(fmt::format("glGetError: 0x{:04x}", error));
  return state_->errors;
}

const std::vector<std::string>& Context::errorMessages() const {
  return state_->messages;
}

}  // namespace lambent::gpu
