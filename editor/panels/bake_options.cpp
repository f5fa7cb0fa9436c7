// Draws the options of a scene's bake, with a widget for each row of the table (baker/bake/option_rows.hpp).
#include <array>
#include <string>

#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "baker/bake/option_rows.hpp"
#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

// Shows a tooltip for the last widget.
void tellHelp(const baker::OptionRow& row) {
  tooltip(std::string(row.kind) + ": " + row.help);
}

// Returns true when another word was chosen or typed.
bool editOptionWord(Marks& marks, const baker::OptionRow& row, const std::string& mark, std::string& word) {
  ImGui::SetNextItemWidth(em(10.7f));
  if (!row.only_words) {
    const bool changed = ImGui::InputText(
        "##word", &word, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    marks.put(mark);
    tellHelp(row);
    return changed;
  }
  const bool open = ImGui::BeginCombo("##word", word.c_str());
  marks.put(mark);
  tellHelp(row);
  if (!open) return false;
  bool changed = false;
  for (const std::string_view choice : row.words) {
    const std::string text(choice);
    if (ImGui::Selectable(text.c_str(), text == word)) word = text, changed = true;
    marks.put(mark + "." + text);
  }
  ImGui::EndCombo();
  return changed;
}

}  // namespace

void drawBakeOptions(Session& session, Marks& marks, std::size_t scene) {
  if (!ImGui::BeginTable("options", 2, ImGuiTableFlags_SizingFixedFit)) return;
  for (const baker::OptionRow& row : baker::optionRows()) {
    const std::string name(row.name);
    std::string word = row.word(session.scenes.entries()[scene].options);
    ImGui::PushID(name.c_str());
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name.c_str());
    tellHelp(row);
    ImGui::TableNextColumn();
    if (editOptionWord(marks, row, "bake-option." + name, word)) {
      const std::array words = {name, word, std::to_string(scene)};
      runOrLog(session, "bake-option", words);
    }
    ImGui::PopID();
  }
  ImGui::EndTable();
  ImGui::TextDisabled("Return takes a word over; they hold from the next bake on.");
}

}  // namespace lambent::editor
