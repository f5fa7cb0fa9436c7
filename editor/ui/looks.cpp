#include "editor/ui/looks.hpp"

#include <array>
#include <filesystem>

#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

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
