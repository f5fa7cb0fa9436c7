#include "editor/ui/marks.hpp"

#include <utility>

#include <imgui.h>

namespace lambent::editor {

void Marks::beginFrame() {
  before_ = std::exchange(now_, {});
  times_.clear();
}

void Marks::put(std::string_view name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  // A tab has no size in its first frame, and cannot be clicked.
  if (low.x >= high.x && low.y >= high.y) return;
  const ImVec2 middle(0.5f * (low.x + high.x), 0.5f * (low.y + high.y));
  // Rows that span all columns of a table are drawn while only their first column is within the clip
  // rectangle.
  const float left = ImGui::GetWindowPos().x, right = left + ImGui::GetWindowWidth();
  const bool shown = left <= middle.x && middle.x < right &&
                     ImGui::IsRectVisible({low.x, middle.y - 0.5f}, {high.x, middle.y + 0.5f});
  put(name, {{low.x, low.y}, {high.x, high.y}, shown});
}

void Marks::put(std::string_view name, const Rectangle& where) {
  std::uint32_t& times = times_[std::string(name)];
  std::string own(name);
  if (++times > 1) own += '#' + std::to_string(times);
  // Another widget may already have the name NAME#2.
  while (!now_.try_emplace(own, where).second) own = std::string(name) + '#' + std::to_string(++times);
}

std::optional<Rectangle> Marks::find(std::string_view name) const {
  const auto found = before_.find(name);
  return found == before_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::string> Marks::names() const {
  std::vector<std::string> names;
  for (const auto& [name, where] : before_) names.push_back(name);
  return names;
}

}  // namespace lambent::editor
