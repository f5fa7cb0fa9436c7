#include <array>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/document/tree.hpp"
#include "editor/panels/panel.hpp"
#include "editor/ui/dear_imgui.hpp"

namespace lambent::editor {

namespace {

// A KindLook is the letter and colour that mark a kind of entity.
struct KindLook {
  std::string_view kind;
  const char* sign;
  ImU32 color;
};
constexpr KindLook kLooks[] = {
    {"bundle", "B", IM_COL32(220, 160, 80, 255)},      {"node", "n", IM_COL32(150, 150, 150, 255)},
    {"light", "L", IM_COL32(250, 220, 110, 255)},      {"lamp", "L", IM_COL32(250, 190, 110, 255)},
    {"camera", "C", IM_COL32(130, 180, 240, 255)},     {"volume", "V", IM_COL32(180, 170, 230, 255)},
    {"animation", "A", IM_COL32(230, 140, 180, 255)},  {"material", "M", IM_COL32(120, 200, 200, 255)},
    {"environment", "E", IM_COL32(120, 170, 250, 255)}};

// Leaves the room of an arrow button. Text behind it stands as high as text behind a button.
void drawLeafSpace() {
  ImGui::AlignTextToFramePadding();
  ImGui::Dummy(ImVec2(ImGui::GetFrameHeight(), ImGui::GetFrameHeight()));
}

void drawKindSign(std::string_view kind) {
  for (const KindLook& look : kLooks)
    if (look.kind == kind) {
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(look.color), "%s", look.sign);
      tooltip(kind);
      return;
    }
  ImGui::TextDisabled("-");
}

void select(Session& session, const std::vector<TreeRow>& rows, const TreeRow& row) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.KeyShift) {
    std::vector<StableId> ids;
    for (const TreeRow& r : rows) ids.push_back(r.id);
    session.selection.range(ids, row.id);
  } else if (io.KeyCtrl) {
    session.selection.toggle(row.id);
  } else {
    session.selection.set(row.id);
  }
  session.viewing.changed = true;
}

// Writes behind the row of a bundle what its picture lacks.
void drawBundleStatus(Session& session, Marks& marks, const TreeRow& row) {
  const auto& entries = session.scenes.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i].slot || session.stage.world().instance(*entries[i].slot).root != row.entity) continue;
    const SceneStatus status = statusOf(session, i);
    if (status.standing == Standing::Good) return;
    const float name = ImGui::CalcTextSize(row.name.c_str()).x + em(0.5f);
    ImGui::SameLine(ImGui::GetItemRectMin().x - ImGui::GetWindowPos().x + name);
    fittedText(standingColor(status.standing), status.text, status.detail);
    marks.put("scene." + row.name + ".state");
  }
}

// Draws the row of a scene of which nothing is shown yet: its bake runs or failed, or it is not there.
// Returns false if it was closed.
bool drawUnshown(Session& session, Marks& marks, std::size_t i) {
  const SceneEntry& entry = session.scenes.entries()[i];
  const SceneStatus status = statusOf(session, i);
  const std::string number = std::to_string(i);
  ImGui::PushID(static_cast<int>(i));
  drawLeafSpace();
  ImGui::SameLine(0.0f, 4.0f);
  drawKindSign("bundle");
  ImGui::SameLine(0.0f, 6.0f);
  ImGui::TextDisabled("%s", entry.id.c_str());
  ImGui::SameLine();
  fittedText(standingColor(status.standing), status.text, status.detail);
  marks.put("scene." + entry.id + ".state");
  const bool close = [&] {
    if (!ImGui::BeginPopupContextItem("unshown")) return false;
    if (!entry.source.empty() && ImGui::MenuItem("Bake")) runOrLog(session, "bake", std::array{number});
    const bool chosen = ImGui::MenuItem("Close");
    ImGui::EndPopup();
    return chosen;
  }();
  ImGui::PopID();
  if (close) runOrLog(session, "close", std::array{number});
  return !close;
}

// Draws the menu that a right click on a row opens.
void drawRowMenu(Session& session, Marks& marks, const TreeRow& row) {
  if (!ImGui::BeginPopupContextItem("row")) return;
  if (!session.selection.contains(row.id)) session.selection.set(row.id);
  drawSelectionMenu(session, marks);
  ImGui::EndPopup();
}

void drawTreeRow(Session& session, Marks& marks, TreeQuery& query, const std::vector<TreeRow>& rows,
                 const TreeRow& row) {
  ImGui::PushID(static_cast<int>(row.id.value ^ row.id.value >> 32));
  const float indent = em(0.8f) * static_cast<float>(row.depth);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
  if (row.has_children) {
    if (ImGui::ArrowButton("open", row.open ? ImGuiDir_Down : ImGuiDir_Right)) {
      if (row.open)
        query.closed.insert(row.id);
      else
        query.closed.erase(row.id);
    }
  } else {
    drawLeafSpace();
  }
  ImGui::SameLine(0.0f, 4.0f);
  drawKindSign(row.kind);
  ImGui::SameLine(0.0f, 6.0f);
  if (!row.matches) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
  const std::string shown = ellipsized(row.name, ImGui::GetContentRegionAvail().x);
  if (ImGui::Selectable(shown.c_str(), session.selection.contains(row.id))) select(session, rows, row);
  if (!row.matches) ImGui::PopStyleColor();
  marks.put("scene." + row.name);
  if (shown != row.name) tooltip(row.name);
  drawRowMenu(session, marks, row);
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
    session.viewing.frame(session.document, selectionBounds(session.document, session.selection));
  if (ImGui::BeginDragDropSource()) {
    ImGui::SetDragDropPayload("entity", &row.id, sizeof row.id);
    ImGui::TextUnformatted(row.name.c_str());
    ImGui::EndDragDropSource();
  }
  if (ImGui::BeginDragDropTarget()) {
    if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload("entity")) {
      const StableId moved = *static_cast<const StableId*>(payload->Data);
      const ecs::Entity child[] = {session.document.find(moved)};
      if (auto done = session.history.reparent(child, row.entity, /*keep_place=*/true); !done)
        session.log.error(done.error());
      else if (!session.document.created(child[0]))
        session.log.note(row.name + " carries " + session.document.nameOf(moved) +
                         " in this world; a bake takes over where it stands, and keeps the scene's own tree");
    }
    ImGui::EndDragDropTarget();
  }
  if (row.kind == "bundle") drawBundleStatus(session, marks, row);
  ImGui::PopID();
}

}  // namespace

void drawSceneTree(Session& session, Marks& marks) {
  TreeQuery& query = session.tree.query;
  ImGui::SetNextItemWidth(-1.0f);
  ImGui::InputTextWithHint("##search", "search", &query.filter);
  marks.put("scene.search");
  tooltip("Part of a name, as ball; a kind, as type:light; a component, as has:Lamp");
  fittedText(dimmed(), fmt::format("{} selected", session.selection.ids().size()));
  const std::vector<TreeRow>& rows = session.tree.of(session.document);
  ImGui::BeginChild("rows");
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i)
    if (!session.scenes.entries()[i].slot && !drawUnshown(session, marks, i)) break;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
      drawTreeRow(session, marks, query, rows, rows[static_cast<std::size_t>(i)]);
  if (ImGui::IsWindowHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsAnyItemHovered())
    session.selection.clear();
  ImGui::EndChild();
}

}  // namespace lambent::editor
