#include "editor/panels/object_materials.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include "editor/panels/field_words.hpp"
#include "editor/panels/fields.hpp"
#include "editor/ui/dear_imgui.hpp"
#include "editor/ui/fitting.hpp"

namespace lambent::editor {

namespace {

constexpr float kSwatchEms = 1.6f, kPictureEms = 4.0f;

// Asks for the pictures of a material, and returns those that are there.
MaterialPictures::Pictures picturesOf(Session& session, ecs::Entity material) {
  session.material_pictures.wanted.insert(material);
  const auto found = session.material_pictures.of.find(material);
  return found == session.material_pictures.of.end() ? MaterialPictures::Pictures{} : found->second;
}

void drawThumbnail(std::uint32_t picture, float size) {
  if (picture != 0)
    ImGui::Image(textureOf(picture), ImVec2(size, size));
  else
    ImGui::Dummy(ImVec2(size, size));
}

void drawMaterial(Session& session, Marks& marks, ecs::Entity material) {
  const std::string name = session.document.nameOf(material);
  const float height = em(kSwatchEms);
  drawThumbnail(picturesOf(session, material).preview, height);
  ImGui::SameLine();
  const float select = ImGui::CalcTextSize("Select").x + 3.0f * ImGui::GetStyle().FramePadding.x;
  const std::string shown =
      ellipsized(name, ImGui::GetContentRegionAvail().x - select - ImGui::GetTreeNodeToLabelSpacing());
  const bool open = ImGui::TreeNodeEx("##fields", ImGuiTreeNodeFlags_FramePadding, "%s", shown.c_str());
  marks.put("inspector.material." + name);
  tooltip(name + "\nOpen it to edit it here");
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - select);
  if (ImGui::SmallButton("Select")) session.selection.set(session.document.idOf(material));
  marks.put("inspector.material." + name + ".select");
  if (!open) return;
  drawMaterialPictures(session, marks, material);
  const ecs::Entity one[] = {material};
  drawFields(session, marks, *scene::findComponent(scene::MaterialComponent::kComponentName), one);
  ImGui::TreePop();
}

}  // namespace

void drawMaterialPictures(Session& session, Marks& marks, ecs::Entity material) {
  const MaterialPictures::Pictures pictures = picturesOf(session, material);
  const float size = em(kPictureEms), right = ImGui::GetWindowContentRegionMax().x + ImGui::GetWindowPos().x;
  drawThumbnail(pictures.preview, size);
  marks.put("inspector.preview");
  tooltip("The material's factors, without its textures");
  for (const MaterialPictures::Texture& texture : pictures.textures) {
    ImGui::SameLine();
    if (ImGui::GetCursorScreenPos().x + size > right) ImGui::NewLine();
    ImGui::BeginGroup();
    drawThumbnail(texture.picture, size);
    ImGui::EndGroup();
    marks.put("inspector.texture." + std::string(texture.use));
    const std::string pixels =
        texture.width > 0 ? fmt::format("{} x {}", texture.width, texture.height) : "not loaded";
    tooltip(fmt::format("{}: {}\n{}, {}", fieldLabel("Material", texture.use), texture.name, pixels,
                        texture.use));
  }
}

void drawObjectMaterials(Session& session, Marks& marks, ecs::Entity object) {
  const std::vector<ecs::Entity> materials = materialsOf(session, object);
  if (materials.empty()) return;
  const bool open = ImGui::CollapsingHeader("Materials", ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("inspector.materials");
  if (!open) return;
  for (const ecs::Entity material : materials) {
    ImGui::PushID(static_cast<int>(material.index));
    drawMaterial(session, marks, material);
    ImGui::PopID();
  }
}

void drawPrimitive(Session& session, Marks& marks, ecs::Entity draw) {
  const auto* item = session.document.registry().tryGet<scene::DrawItem>(draw);
  if (!item) return;
  const bool open = ImGui::CollapsingHeader("Primitive", ImGuiTreeNodeFlags_DefaultOpen);
  marks.put("inspector.primitive");
  if (!open || !beginFieldTable("primitive")) return;
  const PrimitiveFacts facts = factsOf(session, *item);
  const auto row = [](std::string_view label, std::string_view help, const std::string& value) {
    beginFieldRow(label, help);
    fittedText(value);
  };
  row("Node", "It moves with this node", session.document.nameOf(item->node));
  row("Mesh", "", facts.mesh.empty() ? fmt::format("number {}", item->mesh) : facts.mesh);
  row("Vertices", "", std::to_string(facts.vertices));
  row("Triangles", "", std::to_string(facts.triangles));
  row("Light", "Where the light that was baked is evaluated", facts.shading);
  if (item->back) row("Side", "Of a double-sided surface", "back");
  ImGui::EndTable();
}

}  // namespace lambent::editor
