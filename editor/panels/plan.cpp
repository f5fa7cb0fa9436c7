#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/panel.hpp"
#include "editor/panels/text.hpp"
#include "editor/session/names.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

void sentence(const std::string& text) {
  ImGui::Bullet();
  ImGui::TextWrapped("%s", text.c_str());
}

void drawEffects(const baker::EffectPlan& plan) {
  for (const baker::EffectChoice& choice : plan.effects) {
    ImGui::PushStyleColor(ImGuiCol_Text,
                          choice.baked ? kGoodColor : ImGui::GetStyle().Colors[ImGuiCol_TextDisabled]);
    ImGui::Text("%s: %s", choice.effect.c_str(), choice.baked ? "baked" : "not baked");
    ImGui::PopStyleColor();
    ImGui::Indent();
    ImGui::TextWrapped("%s", choice.reason.c_str());
    ImGui::Unindent();
  }
}

void drawGroup(const baker::EffectPlan& plan, std::size_t g) {
  const baker::RigidGroup& group = plan.groups[g];
  if (!ImGui::TreeNode(group.name.empty() ? "(no name)" : group.name.c_str())) return;
  if (group.volume >= 0) {
    sentence("a volume");
  } else {
    const auto& [count, reason] = plan.light_probes[g];
    sentence(fmt::format("{} draws", group.draws.size()));
    sentence(fmt::format("light from outside at {} points of {}: {}", count.count,
                         count.of_group ? "the group" : "each cell", reason));
  }
  const baker::PlannedNeighborhood& around = plan.neighborhoods[g];
  if (!around.reason.empty())
    sentence(fmt::format("{}: {}", around.baked ? "neighborhood" : "no neighborhood", around.reason));
  ImGui::TreePop();
}

}  // namespace

void drawPlan(Session& session, Marks& marks) {
  const auto entry = sceneAtHand(session);
  if (!entry) {
    sentence("Open a scene to see what its bake simulates, and why.");
    return;
  }
  const SceneEntry& scene = session.scenes.entries()[*entry];
  if (scene.source.empty()) {
    sentence(scene.id + " is a bundle alone: its plan was made when it was baked.");
    return;
  }
  const Result<ScenePlan>* made = session.plans.find(scene.source, scene.options);
  if (!made) {
    sentence("Reads the scene...");
    return;
  }
  if (!*made) {
    ImGui::PushStyleColor(ImGuiCol_Text, kErrorColor);
    sentence(made->error().line());
    ImGui::PopStyleColor();
    return;
  }
  const baker::EffectPlan& plan = (*made)->plan;
  fittedText(scene.source.filename().string(), scene.source.string());
  marks.put("plan.scene");
  drawEffects(plan);
  if (ImGui::CollapsingHeader("Rigid groups", ImGuiTreeNodeFlags_DefaultOpen))
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
      ImGui::PushID(static_cast<int>(g));
      drawGroup(plan, g);
      ImGui::PopID();
    }
  const auto list = [](const char* title, const std::vector<std::string>& sentences) {
    if (sentences.empty() || !ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen)) return;
    for (const std::string& text : sentences) sentence(text);
  };
  list("Lamps that come near", plan.shadowed_lights);
  list("Left out", plan.left_out);
  list("Warnings of the import", (*made)->warnings);
}

}  // namespace lambent::editor
