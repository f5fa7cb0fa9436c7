#include "editor/ui/fitting.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui.h>

namespace lambent::editor {

namespace {

constexpr std::string_view kEllipsis = "...";
constexpr float kTooltipEms = 32.0f;

float widthOf(std::string_view text) {
  return ImGui::CalcTextSize(text.data(), text.data() + text.size()).x;
}

}  // namespace

float em(float heights) {
  return heights * ImGui::GetFontSize();
}

std::string ellipsized(std::string_view text, float width) {
  if (widthOf(text) <= width) return std::string(text);
  const float room = width - widthOf(kEllipsis);
  std::size_t fits = 0, too_long = text.size();
  while (fits + 1 < too_long) {
    const std::size_t middle = (fits + too_long) / 2;
    (widthOf(text.substr(0, middle)) <= room ? fits : too_long) = middle;
  }
  // A character of several bytes is left out whole.
  while (fits > 0 && (static_cast<unsigned char>(text[fits]) & 0xc0u) == 0x80u) --fits;
  return std::string(text.substr(0, fits)).append(kEllipsis);
}

void tooltip(std::string_view text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(em(kTooltipEms));
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void fittedTextBeside(std::string_view text, float width, std::string_view more) {
  const std::string shown = ellipsized(text, ImGui::GetContentRegionAvail().x - width);
  ImGui::TextUnformatted(shown.c_str());
  if (shown == text)
    tooltip(more);
  else
    tooltip(more.empty() ? std::string(text) : fmt::format("{}\n{}", text, more));
}

void fittedText(std::string_view text, std::string_view more) {
  fittedTextBeside(text, 0.0f, more);
}

bool sameLineIfFits(std::string_view button) {
  return sameLineIfFits(widthOf(button) + 2.0f * ImGui::GetStyle().FramePadding.x);
}

bool sameLineIfFits(float width) {
  const float end = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width;
  if (end > ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) return false;
  ImGui::SameLine();
  return true;
}

const char* numberFormat(float value, float width, int digits) {
  constexpr std::array kFormats = {"%.0f", "%.1f", "%.2f", "%.3f", "%.4f"};
  const float room = width - 2.0f * ImGui::GetStyle().FramePadding.x;
  int shown = std::clamp(digits, 0, static_cast<int>(kFormats.size()) - 1);
  while (shown > 0 && widthOf(fmt::format("{:.{}f}", value, shown)) > room) --shown;
  return kFormats[static_cast<std::size_t>(shown)];
}

}  // namespace lambent::editor
