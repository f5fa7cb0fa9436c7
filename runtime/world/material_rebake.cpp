#include "runtime/world/material_rebake.hpp"

#include <algorithm>

#include "runtime/bundle/material_fields.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::frame {

namespace {

// Returns the name of the first value of reflection that differs, or nothing if none does.
std::string changedReflection(const gltf::Material& a, const gltf::Material& b) {
  std::string changed;
  gltf::forEachLiveValue([&](const auto& field, const auto& live) {
    if (changed.empty() && field.part == gltf::MaterialPart::Reflection && a.*field.member != b.*field.member)
      changed = live.name;
  });
  return changed;
}

// Follows the rule by which surface_record.cpp chooses a table.
bool tableMissing(const gltf::Material& material, const std::vector<bundle::BrdfFamily>& tables) {
  using Family = bundle::BrdfFamily;
  const Family family = bundle::brdfFamilyOf(material);
  if (family == Family::Measured) {
    const auto index = static_cast<std::size_t>(material.brdf);
    return index >= tables.size() || tables[index] != Family::Measured;
  }
  const auto has = [&](Family wanted) { return std::ranges::find(tables, wanted) != tables.end(); };
  if (family == Family::AnisotropicGgx) return !has(Family::AnisotropicGgx);
  return !has(Family::Ggx) && !has(Family::AnisotropicGgx);
}

// Adds what does not show of a smooth dielectric. Its layer follows all factors, but has no matrices.
template <class Add>
void addForLayer(const gltf::Material& now, const MaterialUse& use, const std::string& field,
                 const Add& add) {
  if (now.brdf >= 0 || now.anisotropy > 0.0f)
    add(now.brdf >= 0 ? "brdf" : "anisotropy", false,
        "It was baked as a smooth dielectric: this shows only after a rebake.");
  else if (now.metallic > 0.0f)
    add("metallic", true, "It was baked as a dielectric, and mirrors little of what is around it.");
  if (use.bounces || use.seen) add(field, true, "Light that bounces off it still does so as it was baked.");
}

}  // namespace

MaterialUse materialUse(const bundle::Description& description, std::uint32_t material) {
  MaterialUse use;
  for (const bundle::BrdfTableEntry& table : description.brdf_tables) use.tables.push_back(table.family);
  for (const bundle::Draw& draw : description.draws) {
    const std::int32_t of_draw = description.meshes[draw.mesh].primitives[draw.primitive].material;
    if (of_draw != static_cast<std::int32_t>(material)) continue;
    const bundle::Group& group = description.groups[draw.group];
    use.glossy |= draw.glossy();
    use.layered |= bundle::isLayered(description, draw);
    use.normal_mapped |= draw.form() == transfer::Form::NormalMapped;
    use.diffuse |= draw.form() == transfer::Form::Vector;
    for (const bundle::Cell& cell : group.cells)
      for (const bundle::CellTransfer& transfer : cell.transfers)
        use.bounces |= transfer.shape.full_channels > 0;
    use.seen |= group.proxy >= 0 && description.groups.size() > 1;
    for (const bundle::GroupLight& light : group.lights)
      use.lamp |= light.kind == bundle::GroupLight::Kind::Material && light.index == material;
  }
  return use;
}

std::vector<RebakeReason> needsRebake(const gltf::Material& now, const gltf::Material& baked,
                                      const MaterialUse& use) {
  std::vector<RebakeReason> reasons;
  const auto add = [&](const std::string& field, bool shows, const char* sentence) {
    reasons.push_back({.field = field, .sentence = sentence, .shows = shows});
  };
  const bool other_color = glm::vec3(now.base_color) != glm::vec3(baked.base_color);
  if (other_color && use.bounces)
    add("base_color", true, "Bounced light still carries the color that was baked.");
  if (other_color && use.seen)
    add("base_color", true, "What it throws on other bodies still has the color that was baked.");
  if (now.alpha_mode != gltf::AlphaMode::Opaque &&
      (now.base_color.a != baked.base_color.a || now.alpha_cutoff != baked.alpha_cutoff))
    add(now.base_color.a != baked.base_color.a ? "alpha" : "alpha_cutoff", true,
        now.alpha_mode == gltf::AlphaMode::Mask ? "The cut-outs of its baked shadow stay as they were."
                                                : "Its baked shadow stays as it was.");
  if (const std::string field = changedReflection(now, baked); !field.empty()) {
    if ((use.diffuse || use.normal_mapped) && !use.layered && now.isDiffuse() != baked.isDiffuse())
      add(field, false, "It was baked as a diffuse surface: roughness and metal show only after a rebake.");
    if (use.layered) addForLayer(now, use, field, add);
    if (use.glossy) {
      if (tableMissing(now, use.tables))
        add(now.brdf >= 0 ? "brdf" : "anisotropy", false,
            now.brdf >= 0 ? "The bundle has no measured table of this number."
            : now.anisotropy > 0.0f
                ? "The bundle has no table of reflection along a direction: it shows only after a rebake."
                : "The bundle has only measured tables: factors of the material show only after a rebake.");
      if (use.bounces || use.seen)
        add(field, true, "Light that bounces off it still does so as it was baked.");
      if (now.isDiffuse())
        add(field, true, "It is diffuse now, and still shaded by the few bands of a glossy surface.");
    }
  }
  if (now.normal_scale != baked.normal_scale && now.normal_texture.texture >= 0 && use.diffuse)
    add("normal_scale", false, "It was baked without its normal map: bumps show only after a rebake.");
  if (now.emissive != baked.emissive && !use.lamp)
    add("emission", true, "What it gives off can be seen, but lights nothing before a rebake.");
  return reasons;
}

}  // namespace lambent::frame
