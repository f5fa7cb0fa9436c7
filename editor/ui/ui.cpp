#include "editor/ui/ui.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <imgui.h>
#define GLFW_INCLUDE_NONE
#include <array>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include "editor/ui/dear_imgui.hpp"

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

namespace {

constexpr float kFontPixels = 15.0f;
constexpr float kDefaultFontPixels = 13.0f;  // what Dear ImGui's own font was drawn for

constexpr std::array kFonts = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                               "/usr/share/fonts/TTF/DejaVuSans.ttf",
                               "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf"};

// The ranges are Basic Latin, Latin-1, Greek (sigma, pi), general punctuation, superscripts, arrows and
// mathematical operators.
constexpr std::array<ImWchar, 13> kGlyphs = {0x20,   0xff,   0x370,  0x3ff,  0x2010, 0x205e, 0x2070,
                                             0x209f, 0x2190, 0x21ff, 0x2200, 0x22ff, 0};

ImVec4 grey(float value, float alpha = 1.0f) {
  return {value, value, value + 0.008f, alpha};
}

void setColors(ImGuiStyle& style) {
  ImGui::StyleColorsDark();
  ImVec4* colors = style.Colors;
  const ImVec4 accent(0.86f, 0.56f, 0.2f, 1.0f), accent_dim(0.62f, 0.4f, 0.15f, 1.0f);
  colors[ImGuiCol_WindowBg] = grey(0.115f);
  colors[ImGuiCol_ChildBg] = grey(0.115f, 0.0f);
  colors[ImGuiCol_PopupBg] = grey(0.09f, 0.98f);
  colors[ImGuiCol_MenuBarBg] = grey(0.085f);
  colors[ImGuiCol_Border] = grey(0.2f);
  colors[ImGuiCol_FrameBg] = grey(0.17f);
  colors[ImGuiCol_FrameBgHovered] = grey(0.22f);
  colors[ImGuiCol_FrameBgActive] = grey(0.26f);
  colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = grey(0.085f);
  colors[ImGuiCol_Header] = grey(0.22f);
  colors[ImGuiCol_HeaderHovered] = grey(0.27f);
  colors[ImGuiCol_HeaderActive] = grey(0.32f);
  colors[ImGuiCol_Button] = grey(0.22f);
  colors[ImGuiCol_ButtonHovered] = grey(0.29f);
  colors[ImGuiCol_ButtonActive] = accent_dim;
  colors[ImGuiCol_Tab] = grey(0.13f);
  colors[ImGuiCol_TabHovered] = grey(0.28f);
  colors[kColorOfOpenTab] = grey(0.23f);
  colors[ImGuiCol_CheckMark] = colors[ImGuiCol_SliderGrabActive] = accent;
  colors[ImGuiCol_SliderGrab] = accent_dim;
  colors[ImGuiCol_PlotLines] = accent;
  colors[ImGuiCol_PlotHistogram] = accent_dim;  // of progress bars, too: white text stands on it
  colors[kColorOfKeyboardCursor] = accent;
  colors[ImGuiCol_TextSelectedBg] = ImVec4(accent.x, accent.y, accent.z, 0.35f);
  colors[ImGuiCol_Separator] = grey(0.2f);
  colors[ImGuiCol_TableHeaderBg] = grey(0.16f);
  colors[ImGuiCol_ScrollbarBg] = grey(0.1f, 0.4f);
}

}  // namespace

void setLooks(float scale) {
  ImGuiIO& io = ImGui::GetIO();
  for (const char* file : kFonts)
    if (std::error_code ignored; std::filesystem::exists(file, ignored)) {
      io.Fonts->AddFontFromFileTTF(file, kFontPixels * scale, nullptr, kGlyphs.data());
      break;
    }
  if (io.Fonts->Fonts.empty()) {
    ImFontConfig config;
    config.SizePixels = kDefaultFontPixels * scale;
    io.Fonts->AddFontDefault(&config);
  }
  ImGuiStyle& style = ImGui::GetStyle();
  setColors(style);
  style.WindowRounding = style.ChildRounding = 0.0f;
  style.FrameRounding = style.GrabRounding = style.TabRounding = style.PopupRounding = 3.0f;
  style.WindowPadding = ImVec2(8.0f, 6.0f);
  style.FramePadding = ImVec2(6.0f, 3.0f);
  style.ItemSpacing = ImVec2(7.0f, 4.0f);
  style.ScrollbarSize = 12.0f;
  style.WindowBorderSize = 1.0f;
  style.IndentSpacing = 16.0f;
  style.ScaleAllSizes(scale);
}

}  // namespace lambent::editor
