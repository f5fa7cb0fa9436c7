#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <tuple>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "runtime/base/process.hpp"

namespace lambent::editor {

namespace {

constexpr std::size_t kMostPlaces = 8;

std::vector<DialogPlace> dialogPlacesOf(const Session& session) {
  std::vector<DialogPlace> places;
  const auto add = [&](std::string name, const std::filesystem::path& folder) {
    std::error_code ignored;
    const bool known = std::ranges::find(places, folder, &DialogPlace::folder) != places.end();
    if (!known && !folder.empty() && std::filesystem::is_directory(folder, ignored))
      places.push_back({std::move(name), folder});
  };
  if (const char* home = std::getenv("HOME")) add("Home", home);
  for (const SceneEntry& entry : session.scenes.entries()) add("Scene", entry.source.parent_path());
  if (const auto samples = sampleFolders(); !samples.empty()) add("Samples", samples.front());
  for (const std::string& recent : session.preferences.recent) {
    const std::filesystem::path folder = std::filesystem::path(recent).parent_path();
    add(folder.filename().string(), folder);
  }
  places.resize(std::min(places.size(), kMostPlaces));
  return places;
}

bool shown(const Dialog& dialog, const DialogFile& file) {
  if (file.name.starts_with('.')) return false;
  if (file.is_folder) return true;
  if (dialog.kind == Dialog::Kind::Folder) return false;
  return dialog.endings.empty() || std::ranges::any_of(dialog.endings, [&](const std::string& ending) {
           return file.name.ends_with(ending);
         });
}

std::vector<DialogFile> filesOf(const Dialog& dialog) {
  std::vector<DialogFile> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(dialog.folder, ignored)) {
    DialogFile file{entry.path().filename().string(), entry.is_directory(ignored)};
    if (shown(dialog, file)) files.push_back(std::move(file));
  }
  std::ranges::sort(files, {}, [](const DialogFile& file) {
    return std::tuple(!file.is_folder, std::string_view(file.name));
  });
  return files;
}

// Brings what the dialog lists up to date. Folders that cannot be read are empty.
void list(const Session& session, Dialog& dialog) {
  if (!dialog.listed.known()) dialog.places = dialogPlacesOf(session);
  std::error_code ignored;
  const auto written = std::filesystem::last_write_time(dialog.folder, ignored);
  if (dialog.listed.renew(dialog.folder, written)) dialog.files = filesOf(dialog);
}

std::string answerOf(const Dialog& dialog) {
  if (dialog.kind == Dialog::Kind::Text) return dialog.name;
  if (dialog.kind == Dialog::Kind::Confirm) return {};
  const std::filesystem::path name(dialog.name);
  return (name.is_absolute() ? name : dialog.folder / name).string();
}

void drawPlaces(Dialog& dialog, Marks& marks) {
  const std::vector<DialogPlace>& places = dialog.places;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0) sameLineIfFits(places[i].name);
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Button(places[i].name.c_str())) dialog.folder = places[i].folder;
    ImGui::PopID();
    marks.put("dialog.place." + places[i].name);
    tooltip(places[i].folder.string());
  }
}

// Returns whether a file was chosen, by a double click or by the Enter key.
bool drawFiles(const Session& session, Dialog& dialog, Marks& marks) {
  bool chosen = false;
  list(session, dialog);
  drawPlaces(dialog, marks);
  std::string folder = dialog.folder.string();
  ImGui::SetNextItemWidth(-em(4.0f));
  if (ImGui::InputText("##folder", &folder, ImGuiInputTextFlags_EnterReturnsTrue)) dialog.folder = folder;
  marks.put("dialog.folder");
  ImGui::SameLine();
  if (ImGui::Button("Up")) dialog.folder = dialog.folder.parent_path();
  marks.put("dialog.up");
  ImGui::BeginChild("files", ImVec2(0.0f, std::min(em(17.3f), 0.5f * ImGui::GetIO().DisplaySize.y)), true);
  std::filesystem::path enter;
  for (const auto& [name, is_folder] : dialog.files) {
    if (ImGui::Selectable((is_folder ? name + "/" : name).c_str(), dialog.name == name,
                          ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_DontClosePopups)) {
      const bool twice = ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
      if (is_folder && twice)
        enter = dialog.folder / name;
      else if (!is_folder || dialog.kind == Dialog::Kind::Folder)
        dialog.name = name, chosen = twice && !is_folder;
    }
    marks.put("dialog." + name);
  }
  ImGui::EndChild();
  if (!enter.empty()) dialog.folder = enter, dialog.name.clear();
  ImGui::SetNextItemWidth(-1.0f);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();  // so that a name can be typed at once
  if (ImGui::InputTextWithHint("##name", dialog.kind == Dialog::Kind::Folder ? "this folder" : "file",
                               &dialog.name, ImGuiInputTextFlags_EnterReturnsTrue))
    chosen = true;
  marks.put("dialog.name");
  // The name of a folder leads into it.
  std::error_code ignored;
  const std::filesystem::path named = answerOf(dialog);
  if (!chosen || dialog.name.empty() || dialog.kind == Dialog::Kind::Folder ||
      !std::filesystem::is_directory(named, ignored))
    return chosen;
  dialog.folder = named.lexically_normal();
  dialog.name.clear();
  return false;
}

}  // namespace

void drawDialogs(Session& session, Marks& marks) {
  if (!session.window.dialog) return;
  // The answer may open another dialog, so the present one is copied first.
  Dialog& dialog = *session.window.dialog;
  const std::string title = dialog.title + "###dialog";
  if (!ImGui::IsPopupOpen(title.c_str())) ImGui::OpenPopup(title.c_str());
  ImGui::SetNextWindowSize(ImVec2(
      std::min(em(dialog.kind == Dialog::Kind::Confirm || dialog.kind == Dialog::Kind::Text ? 28.0f : 41.0f),
               0.96f * ImGui::GetIO().DisplaySize.x),
      0.0f));
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * screen.x, 0.4f * screen.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  if (!ImGui::BeginPopupModal(title.c_str(), nullptr, ImGuiWindowFlags_NoSavedSettings)) return;
  bool yes = false, no = false, third = false;
  if (!dialog.question.empty()) {
    const float wrap = ImGui::GetContentRegionAvail().x;
    const float height = ImGui::CalcTextSize(dialog.question.c_str(), nullptr, false, wrap).y + 8.0f;
    ImGui::BeginChild("question", ImVec2(0.0f, std::min(height, 0.7f * screen.y)));
    ImGui::TextWrapped("%s", dialog.question.c_str());
    ImGui::EndChild();
  }
  if (dialog.kind == Dialog::Kind::Text) {
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    yes = ImGui::InputText("##text", &dialog.name, ImGuiInputTextFlags_EnterReturnsTrue);
    marks.put("dialog.text");
  } else if (dialog.kind != Dialog::Kind::Confirm) {
    yes = drawFiles(session, dialog, marks);
  }
  yes |= ImGui::Button(dialog.yes.c_str(), ImVec2(em(7.4f), 0.0f));
  marks.put("dialog.yes");
  const auto button = [&](const std::string& text, const char* mark) {
    if (text.empty()) return false;
    ImGui::SameLine();
    const bool pressed = ImGui::Button(text.c_str(), ImVec2(em(7.4f), 0.0f));
    marks.put(mark);
    return pressed;
  };
  third = button(dialog.third, "dialog.third");
  no = button(dialog.no, "dialog.no") || escapePressed();
  if (yes || no || third) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  if (!yes && !no && !third) return;
  const Dialog answered = std::move(dialog);
  session.window.dialog.reset();
  if (yes && answered.answered) answered.answered(session, answerOf(answered));
  if (third && answered.third_chosen) answered.third_chosen(session);
}

}  // namespace lambent::editor
