#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "runtime/gpu/context.hpp"

#define GLFW_INCLUDE_NONE  // epoxy declares OpenGL's functions
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

namespace lambent::gpu {

struct Window::State {
  GLFWwindow* window = nullptr;
  std::optional<Context> context;
  Input pending;
  double last_x = 0.0, last_y = 0.0;

  ~State() {
    context.reset();
    if (window != nullptr) glfwDestroyWindow(window);
    glfwTerminate();
  }

  static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }

  static void onScroll(GLFWwindow* window, double, double notches) {
    of(window).pending.scroll += static_cast<float>(notches);
  }
  static void onKey(GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    Input& input = of(window).pending;
    if (key == GLFW_KEY_ESCAPE) input.quit = true;
    if (key == GLFW_KEY_R) input.reset = true;
    if (key == GLFW_KEY_SPACE) input.pause = true;
    if (key == GLFW_KEY_H) input.help = true;
  }
  static void onDrop(GLFWwindow* window, int count, const char** paths) {
    for (int i = 0; i < count; ++i) of(window).pending.dropped.emplace_back(paths[i]);
  }
  static void onMove(GLFWwindow* window, double x, double y) {
    State& state = of(window);
    int width = 1, height = 1;
    glfwGetWindowSize(window, &width, &height);
    const auto right = static_cast<float>((x - state.last_x) / std::max(height, 1));
    const auto down = static_cast<float>((y - state.last_y) / std::max(height, 1));
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
      state.pending.drag_x += right;
      state.pending.drag_y += down;
    }
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
      state.pending.light_x += right;
      state.pending.light_y += down;
    }
    state.last_x = x;
    state.last_y = y;
  }
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

Result<Window> Window::create(const std::string& title, std::uint32_t width, std::uint32_t height,
                              const ContextOptions& options) {
  constexpr const char* kHint = "give --headless OUT.png to render without a display";
  const auto reason = [] {
    const char* text = nullptr;
    glfwGetError(&text);
    return std::string(text ? text : "unknown reason");
  };
  if (!glfwInit()) return fail("window", "cannot be opened: " + reason(), kHint);
  auto state = std::make_unique<State>();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
  const auto open = [&] {
    return glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), title.c_str(), nullptr,
                            nullptr);
  };
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);  // checkContext() tells of a reset
  state->window = open();
  if (state->window == nullptr) {
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_NO_ROBUSTNESS);
    state->window = open();
  }
  if (state->window == nullptr) return fail("window", "cannot be opened with OpenGL 4.5: " + reason(), kHint);
  glfwMakeContextCurrent(state->window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(state->window, state.get());
  glfwSetScrollCallback(state->window, &State::onScroll);
  glfwSetKeyCallback(state->window, &State::onKey);
  glfwSetCursorPosCallback(state->window, &State::onMove);
  glfwSetDropCallback(state->window, &State::onDrop);
  Result<Context> context = Context::attachToCurrent(options);
  if (!context) return failAgain(context.error());
  state->context = std::move(*context);
  return Window(std::move(state));
}

GLFWwindow* Window::handle() const {
  return state_->window;
}

Input Window::poll() {
  glfwPollEvents();
  Input input = std::exchange(state_->pending, {});
  const auto held = [&](int key) { return glfwGetKey(state_->window, key) == GLFW_PRESS ? 1 : 0; };
  input.turn = held(GLFW_KEY_D) - held(GLFW_KEY_A);
  input.quit = input.quit || glfwWindowShouldClose(state_->window);
  return input;
}

void Window::framebufferSize(std::uint32_t& width, std::uint32_t& height) const {
  int w = 0, h = 0;
  glfwGetFramebufferSize(state_->window, &w, &h);
  width = static_cast<std::uint32_t>(std::max(w, 1));
  height = static_cast<std::uint32_t>(std::max(h, 1));
}

void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(state_->window, title.c_str());
}
void Window::swap() {
  glfwSwapBuffers(state_->window);
}

}  // namespace lambent::gpu
