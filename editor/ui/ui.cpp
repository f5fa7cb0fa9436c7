#include "editor/ui/ui.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <imgui.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/looks.hpp"

namespace lambent::editor {

struct Ui::State {
  std::vector<std::filesystem::path> dropped;
  double last_input = 0.0;
  bool picture_wanted = false;
  std::optional<spec::Rgba8Image> picture;
  // Tells whether the last frame had scripted input, which is released when the script is over.
  bool scripted_before = false;
  bool woken = true;  // events came since the last frame
};

namespace {

bool anyInput(const ImGuiIO& io) {
  const bool moved = io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f || io.MouseWheel != 0.0f;
  return moved || std::any_of(std::begin(io.MouseDown), std::end(io.MouseDown), [](bool b) { return b; }) ||
         anyKeyHeld() || io.InputQueueCharacters.Size > 0;
}

// Reads the back buffer, because the front buffer of a window may not be readable.
spec::Rgba8Image readBack(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> pixels(std::size_t{width} * height * 4);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_UNSIGNED_BYTE,
               pixels.data());
  spec::Rgba8Image image{width, height, std::vector<std::uint8_t>(pixels.size())};
  const std::size_t row = std::size_t{width} * 4;
  for (std::size_t y = 0; y < height; ++y)
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>((height - 1 - y) * row), row,
                image.texels.begin() + static_cast<std::ptrdiff_t>(y * row));
  for (std::size_t i = 3; i < image.texels.size(); i += 4) image.texels[i] = 255;
  return image;
}

}  // namespace

Ui::Ui(gpu::Window& window, float scale) : window_(window), state_(std::make_unique<State>()) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // preferences.hpp keeps the layout
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  io.ConfigDragClickToInputText = true;
  setLooks(scale);
  ImGui_ImplGlfw_InitForOpenGL(window.handle(), /*install_callbacks=*/true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

Ui::~Ui() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool Ui::wait(double most_s) {
  const double begun = glfwGetTime();
  double x = 0.0, y = 0.0;
  glfwGetCursorPos(window_.handle(), &x, &y);
  glfwWaitEventsTimeout(most_s);
  double x_now = 0.0, y_now = 0.0;
  glfwGetCursorPos(window_.handle(), &x_now, &y_now);
  // An event ends the wait early.
  const bool woken = glfwGetTime() - begun < 0.99 * most_s || x != x_now || y != y_now;
  state_->woken = state_->woken || woken;
  return woken;
}

void Ui::begin(const ScriptedInput* scripted) {
  for (std::filesystem::path& file : window_.poll().dropped) drop(std::move(file));
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  if (scripted) {
    apply(*scripted);
  } else if (state_->scripted_before) {
    apply({});
  }
  state_->scripted_before = scripted != nullptr;
  marks_.beginFrame();
  ImGui::NewFrame();
  if (std::exchange(state_->woken, false) || anyInput(io)) state_->last_input = ImGui::GetTime();
}

void Ui::end() {
  ImGui::Render();
  std::uint32_t width = 1, height = 1;
  window_.framebufferSize(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  glClearColor(0.09f, 0.09f, 0.1f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (std::exchange(state_->picture_wanted, false)) state_->picture = readBack(width, height);
  window_.swap();
}

bool Ui::closeRequested() const {
  return glfwWindowShouldClose(window_.handle()) != 0;
}
void Ui::refuseClose() {
  glfwSetWindowShouldClose(window_.handle(), GLFW_FALSE);
}

std::vector<std::filesystem::path> Ui::takeDropped() {
  return std::exchange(state_->dropped, {});
}
void Ui::drop(std::filesystem::path file) {
  state_->dropped.push_back(std::move(file));
}

double Ui::sinceInput() const {
  return ImGui::GetTime() - state_->last_input;
}

bool Ui::typing() const {
  return ImGui::GetIO().WantTextInput;
}

void Ui::askForPicture() {
  state_->picture_wanted = true;
  state_->picture.reset();
}
std::optional<spec::Rgba8Image> Ui::takePicture() {
  return std::exchange(state_->picture, std::nullopt);
}

}  // namespace lambent::editor
