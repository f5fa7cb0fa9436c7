#include "editor/session/scene_changes.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/matrix.hpp>

#include "editor/document/document.hpp"
#include "editor/session/session.hpp"
#include "runtime/base/finite.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"
#include "runtime/scene/transforms.hpp"
#include "runtime/world/material_rebake.hpp"

namespace lambent::editor {

bool samePlace(const glm::mat4& a, const glm::mat4& b) {
  constexpr float kRounding = 1e-5f, kMetre = 1.0f;
  float axes = 0.0f, place = kMetre;
  for (int row = 0; row < 3; ++row) {
    place = std::max(place, std::abs(b[3][row]));
    for (int column = 0; column < 3; ++column) axes = std::max(axes, std::abs(b[column][row]));
  }
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!(std::abs(a[column][row] - b[column][row]) <= kRounding * (column < 3 ? axes : place)))
        return false;
  return true;
}

void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    const gltf::Node& node = description.nodes[i];
    const auto* transform = registry.tryGet<scene::Transform>(instance.nodes[i]);
    if (!transform || node.animated) continue;
    const ecs::Entity parent =
        node.parent < 0 ? instance.root : instance.nodes[static_cast<std::size_t>(node.parent)];
    glm::mat4 now = scene::localMatrix(*transform);
    if (transform->parent != parent)
      now = glm::mat4(glm::inverse(glm::dmat4(worldFromNode(registry, parent))) *
                      glm::dmat4(worldFromNode(registry, instance.nodes[i])));
    // Below a flat parent no Transform gives it that place; it stays where the scene has it.
    if (isFinite(now) && !samePlace(now, node.parent_from_node)) edits.nodes.push_back({i, node.name, now});
  }
}

namespace {

// Adds a sentence for each node that moved within its rigid group since the bake: the group's transfer still
// has it in the old place. A group that moved as a whole needs none.
void addMovedParts(const ecs::Registry& registry, const bundle::Description& description,
                   const scene::SceneInstance& instance, std::vector<std::string>& sentences) {
  const std::vector<glm::mat4> rest = gltf::worldTransforms(description.nodes);
  std::set<std::uint32_t> told;
  for (const bundle::Draw& draw : description.draws) {
    const auto* group = registry.tryGet<scene::RigidGroupComponent>(instance.groups[draw.group]);
    const auto* node = registry.tryGet<scene::WorldTransform>(instance.nodes[draw.node]);
    if (!group || !node || samePlace(node->world_from_node, group->world_from_rest * rest[draw.node]))
      continue;
    if (!told.insert(draw.node).second) continue;
    sentences.push_back(
        fmt::format("{}: moved within its rigid group, whose shadows and bounces still have it in "
                    "its old place",
                    description.nodes[draw.node].name));
  }
}

void addLights(const ecs::Registry& registry, const bundle::Description& description,
               const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < description.nodes.size(); ++i) {
    const gltf::Node& node = description.nodes[i];
    const auto* now = registry.tryGet<scene::LocalLightComponent>(instance.nodes[i]);
    if (!now || node.light < 0) continue;
    const gltf::Light& light = description.lights[static_cast<std::size_t>(node.light)];
    const float intensity = now->enabled ? now->strength : 0.0f;
    if (now->color == light.color && intensity == light.intensity && now->range_m == light.range_m &&
        now->inner_cone_rad == light.inner_cone_rad && now->outer_cone_rad == light.outer_cone_rad)
      continue;
    edits.lights.push_back(
        {i, node.name, now->color, intensity, now->range_m, now->inner_cone_rad, now->outer_cone_rad});
  }
}

void addMaterials(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits) {
  for (std::uint32_t i = 0; i < instance.materials.size(); ++i) {
    const auto* now = registry.tryGet<scene::MaterialComponent>(instance.materials[i]);
    if (!now) continue;
    const gltf::Material& was = description.materials[i];
    baker::SceneEdits::Material edit = baker::editOf(i, was, scene::withComponent(was, *now));
    if (!edit.values.empty()) edits.materials.push_back(std::move(edit));
  }
}

template <typename Edit>
void keepOthers(const std::vector<Edit>& baked, std::vector<Edit>& edits, std::uint32_t Edit::*index) {
  for (const Edit& old : baked)
    if (std::none_of(edits.begin(), edits.end(), [&](const Edit& edit) { return edit.*index == old.*index; }))
      edits.push_back(old);
}

void keepMaterials(const std::vector<baker::SceneEdits::Material>& baked,
                   std::vector<baker::SceneEdits::Material>& edits) {
  for (const baker::SceneEdits::Material& old : baked) {
    const auto same =
        std::find_if(edits.begin(), edits.end(), [&](const auto& edit) { return edit.index == old.index; });
    if (same == edits.end())
      edits.push_back(old);
    else
      *same = baker::overlaid(old, *same);
  }
}

}  // namespace

const Baseline& SceneChanges::baseline() {
  std::vector<BaselineBundle> bundles;
  // A bundle that replaces another does so some frames after the scenes' version has risen.
  std::pair<std::uint64_t, std::vector<const void*>> of{scenes_.version(), {}};
  for (const SceneEntry& entry : scenes_.entries())
    if (entry.slot) {
      bundles.push_back({&world_.description(*entry.slot), entry.id, entry.instance});
      of.second.push_back(bundles.back().description);
    }
  if (of == baseline_of_) return baseline_;
  auto made = Baseline::create(bundles);
  if (made)
    baseline_ = std::move(*made);
  else
    log_.error(made.error());
  baseline_of_ = std::move(of);
  return baseline_;
}

baker::SceneEdits SceneChanges::editsOf(std::size_t entry) const {
  const SceneEntry& scene = scenes_.entries()[entry];
  if (!scene.slot) return scene.edits;
  baker::SceneEdits edits;
  const ecs::Registry& registry = world_.registry();
  const bundle::Description& description = world_.description(*scene.slot);
  const scene::SceneInstance& instance = world_.instance(*scene.slot);
  addNodeEdits(registry, description, instance, edits);
  addLights(registry, description, instance, edits);
  addMaterials(registry, description, instance, edits);
  // The bundle may itself have been baked with edits. Those that were not changed since still apply.
  keepOthers(scene.shown_edits.nodes, edits.nodes, &baker::SceneEdits::Node::index);
  keepOthers(scene.shown_edits.lights, edits.lights, &baker::SceneEdits::Light::node);
  keepMaterials(scene.shown_edits.materials, edits.materials);
  return edits;
}

std::vector<std::string> SceneChanges::needsRebake(std::size_t entry) const {
  std::vector<std::string> sentences;
  const SceneEntry& scene = scenes_.entries()[entry];
  if (!scene.slot) return sentences;
  const ecs::Registry& registry = world_.registry();
  const bundle::Description& description = world_.description(*scene.slot);
  const scene::SceneInstance& instance = world_.instance(*scene.slot);
  for (std::uint32_t i = 0; i < instance.materials.size(); ++i) {
    const auto* component = registry.tryGet<scene::MaterialComponent>(instance.materials[i]);
    if (!component) continue;
    const gltf::Material now = scene::withComponent(description.materials[i], *component);
    for (const frame::RebakeReason& reason :
         frame::needsRebake(now, description.materials[i], frame::materialUse(description, i)))
      sentences.push_back(fmt::format("{}: {}", description.materials[i].name, reason.sentence));
  }
  addMovedParts(registry, description, instance, sentences);
  return sentences;
}

const std::vector<std::string>& SceneChanges::needsRebakeNow(std::size_t entry) {
  if (rebakes_.size() <= entry) rebakes_.resize(entry + 1);
  Rebake& known = rebakes_[entry];
  // Until all is loaded, a bundle may replace another in any frame.
  const std::pair now{history_.version(), scenes_.version()};
  if (known.of_edits_and_scenes == now && world_.loaded()) return known.sentences;
  known.sentences = needsRebake(entry);
  known.of_edits_and_scenes = world_.loaded() ? std::optional(now) : std::nullopt;
  return known.sentences;
}

namespace {

using baker::JobPhase;

// Returns a sentence if pictures of the shown bundle err by more than they were to.
std::string missedBound(const bundle::Description& description) {
  const bundle::PictureError* worst = nullptr;
  for (const bundle::Group& group : description.groups)
    if (const auto& error = group.picture_error; error && (!worst || error->all > worst->all))
      worst = &*error;
  if (!worst || !bundle::missesBound(double{worst->all}, double{worst->bound})) return {};
  return fmt::format("pictures err by {:.1f} % instead of {:.1f} %", 100.0 * double{worst->all},
                     100.0 * double{worst->bound});
}

bool works(JobPhase phase) {
  return phase == JobPhase::Waiting || phase == JobPhase::Importing || phase == JobPhase::Baking;
}

// Returns whether the scene's options are not those that its last bake was asked for.
bool hasNewOptions(const SceneEntry& entry, const baker::JobState& job) {
  return entry.options.settings() != job.request.options.settings();
}

SceneStatus wanting(std::string text, std::string detail = {}) {
  return {Standing::Wanting, std::move(text), std::move(detail)};
}

}  // namespace

SceneStatus statusOf(Session& session, std::size_t index) {
  const SceneEntry& entry = session.scenes.entries()[index];
  const auto job = session.scenes.jobOf(index);
  if (job && works(job->phase))
    return {Standing::Working, fmt::format("baking {:.0f} %", 100.0 * job->fraction), {}};
  if (job && job->phase == JobPhase::Failed)
    return {Standing::Failed, "bake failed", job->error ? job->error->line() : std::string()};
  if (entry.missing) return {Standing::Failed, "missing", entry.missing->line()};
  if (!entry.slot) return wanting("not baked");
  if (const auto& reasons = session.changes.needsRebakeNow(index); !reasons.empty())
    return wanting("needs a rebake", fmt::format("{}", fmt::join(reasons, "\n")));
  if (job && hasNewOptions(entry, *job))
    return wanting("needs a rebake", "options of the bake were changed since it was asked for");
  if (!entry.source.empty() && entry.shown != entry.bundle)
    return wanting(
        job && job->reached == baker::PreviewLevel::Coarse ? "coarse preview" : "preview without shadows",
        "the final bake was not made: Bake makes it");
  if (std::string missed = missedBound(session.stage.world().description(*entry.slot)); !missed.empty())
    return wanting(std::move(missed), "a higher quality in the bake's options helps");
  if (!job) return {Standing::Good, "bundle", "it was opened without its scene"};
  return {Standing::Good, job->up_to_date ? "up to date" : "baked", {}};
}

SceneStatus worstStatus(Session& session) {
  SceneStatus worst;
  std::size_t as_bad = 0;
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    SceneStatus status = statusOf(session, i);
    if (status.standing == Standing::Good || status.standing < worst.standing) continue;
    as_bad = status.standing == worst.standing ? as_bad + 1 : 1;
    if (as_bad > 1) continue;
    worst = std::move(status);
    worst.text = session.scenes.entries()[i].id + ": " + worst.text;
  }
  if (as_bad > 1) worst.text += fmt::format(", and {} more", as_bad - 1);
  return worst;
}

std::string titleOf(const Session& session) {
  const std::filesystem::path& world = session.files.world();
  std::string name = world.empty() ? "untitled" : world.filename().string();
  if (world.empty() && session.scenes.entries().size() == 1) name = session.scenes.entries().front().id;
  return fmt::format("{}{} - Lambent", name, session.files.modified() ? "*" : "");
}

std::string pictureStatus(const Session& session) {
  const double ms = session.picture.times.median();
  const std::string time = ms < 1000.0 ? fmt::format("{:.1f} ms", ms) : fmt::format("{:.1f} s", 1e-3 * ms);
  return session.picture.settled ? time : "light settles   " + time;
}

}  // namespace lambent::editor
