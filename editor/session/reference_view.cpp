#include "editor/session/reference_view.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/import/gltf.hpp"
#include "baker/import/scene_edits.hpp"
#include "editor/session/session.hpp"
#include "reference/reference.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

namespace {

using scene::LocalLightComponent;

bool isShape(LocalLightComponent::Kind kind) {
  return kind == LocalLightComponent::Kind::Sphere || kind == LocalLightComponent::Kind::Disc;
}

// Calls a function with each light that a person has added to the world, and with its place.
template <typename Visitor>
void forEachLight(const Session& session, const Visitor& visit) {
  const ecs::Registry& registry = session.document.registry();
  for (const auto [entity, light] : registry.view<const LocalLightComponent>())
    if (light.enabled && session.document.created(entity) && registry.has<scene::Transform>(entity))
      visit(light, worldFromNode(registry, entity), session.document.nameOf(entity));
}

std::vector<ReferenceLamp> lampsOf(const Session& session) {
  using Type = gltf::Light::Type;
  std::vector<ReferenceLamp> lamps;
  forEachLight(session, [&](const LocalLightComponent& light, const glm::mat4& place, std::string name) {
    const Type type = light.kind == LocalLightComponent::Kind::Spot          ? Type::Spot
                      : light.kind == LocalLightComponent::Kind::Directional ? Type::Directional
                                                                             : Type::Point;
    if (!isShape(light.kind))
      lamps.push_back({place,
                       {std::move(name), type, light.color, light.strength, light.range_m,
                        light.inner_cone_rad, light.outer_cone_rad}});
  });
  return lamps;
}

void addLamps(const std::vector<ReferenceLamp>& lamps, baker::Scene& scene) {
  for (const ReferenceLamp& lamp : lamps) {
    gltf::Node node;
    node.name = lamp.light.name;
    node.parent_from_node = lamp.world_from_node;
    node.light = static_cast<std::int32_t>(scene.lights.size());
    scene.lights.push_back(lamp.light);
    scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
    scene.nodes.push_back(std::move(node));
  }
}

// Returns the spherical and disc lights that a person has added to the world.
std::vector<spec::Light> shapesOf(const Session& session) {
  std::vector<spec::Light> shapes;
  forEachLight(session, [&](const LocalLightComponent& light, const glm::mat4& place, const std::string&) {
    const glm::vec3 at(place[3]), radiance = light.power();
    if (light.kind == LocalLightComponent::Kind::Sphere)
      shapes.emplace_back(spec::SphereLight{at, light.radius_m, radiance});
    else if (light.kind == LocalLightComponent::Kind::Disc)
      shapes.emplace_back(
          spec::DiscLight{at, -glm::normalize(glm::vec3(place[2])), light.radius_m, radiance});
  });
  return shapes;
}

// Joins all parts into one scene, with animations at this time in seconds. It is slow and may run on any
// thread. Errors: those of importing a part.
Result<baker::Scene> makeReferenceScene(const std::vector<ReferencePart>& parts,
                                        const std::vector<ReferenceLamp>& lamps, float animation_s) {
  baker::Scene all;
  for (const ReferencePart& part : parts) {
    auto scene = baker::importScene(part.source, {});
    if (!scene) return failAgain(scene.error());
    baker::reference::poseAt(*scene, animation_s);
    baker::applyEdits(part.edits, *scene);
    if (all.source.empty()) all.source = part.source;
    const glm::mat4 world_from_scene =
        glm::translate(part.world_from_scene, glm::vec3(scene->origin - part.origin));
    baker::joinScene(std::move(*scene), part.name, world_from_scene, all);
  }
  addLamps(lamps, all);
  return all;
}

bool sameView(const spec::View& a, const spec::View& b) {
  return a.view_from_world == b.view_from_world && a.clip_from_view == b.clip_from_view;
}

// Returns the scenes that are shown, or an error that says why one cannot be traced.
Result<std::vector<ReferencePart>> partsOf(const Session& session) {
  std::vector<ReferencePart> parts;
  const auto& entries = session.scenes.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].source.empty())
      return fail(entries[i].id, "is a bundle alone: there is no scene to trace",
                  "open its .gltf or .glb file in its place");
    if (!entries[i].slot) continue;  // not shown yet
    const scene::SceneInstance& instance = session.stage.world().instance(*entries[i].slot);
    std::error_code ignored;
    parts.push_back({.source = entries[i].source,
                     .time = std::filesystem::last_write_time(entries[i].source, ignored),
                     .name = entries[i].id,
                     .edits = session.changes.editsOf(i),
                     .world_from_scene = worldFromNode(session.document.registry(), instance.root),
                     .origin = session.stage.world().origin()});
  }
  return parts;
}

// Words cannot describe the light if key lights are edited.
bool hasEditedKeys(const lighting::Environment& environment) {
  return std::ranges::any_of(environment.foundKeys(),
                             [](const lighting::Environment::FoundKey& key) { return key.edit.has_value(); });
}

std::shared_ptr<const spec::DistantLights> editedLight(const lighting::Environment& environment) {
  auto light = std::make_shared<spec::DistantLights>();
  for (std::size_t set = 0; set < lighting::Environment::kSets; ++set) {
    const float share = environment.shareOf(set);
    const lighting::Environment::Part shown = environment.shownOf(set);
    light->constant += share * shown.constant;
    for (spec::Disc disc : shown.discs) {
      disc.radiance *= share;
      light->discs.push_back(disc);
    }
    if (share == 0.0f) continue;
    for (const spec::EnvironmentMap* environment_map : shown.environment_maps) {
      light->environment_maps.push_back(*environment_map);
      for (glm::vec3& texel : light->environment_maps.back().image.texels) texel *= share;
    }
  }
  return light;
}

// Holds each distant light and its present strength.
struct Sky {
  std::vector<spec::Light> lights;
  std::vector<float> factors;
};
Sky skyOf(const Stage& stage) {
  Sky sky;
  for (std::size_t set = 0; set < lighting::Environment::kSets; ++set)
    for (const spec::Light& light : set == 0 ? stage.lights() : stage.fadeLights()) {
      sky.lights.push_back(light);
      sky.factors.push_back(stage.environment().shareOf(set));
    }
  return sky;
}

}  // namespace

bool ReferenceView::done() const {
  if (!on() || error_) return true;
  if (!tracer_) return false;
  using Phase = baker::reference::ProgressivePhase;
  const auto status = tracer_->status();
  return status.phase == Phase::Failed ||
         (status.phase == Phase::Finished && seen_ && seen_->generation == status.generation);
}

std::shared_ptr<const baker::reference::Snapshot> ReferenceView::snapshot() const {
  return tracer_ ? tracer_->snapshot() : nullptr;
}

std::string ReferenceView::notice() const {
  if (error_) return error_->line();
  if (!tracer_) return coming_.valid() ? "reads the scene" : "";
  const auto status = tracer_->status();
  if (status.error) return status.error->line();
  if (status.phase == baker::reference::ProgressivePhase::Preparing) return "builds the scene";
  const auto now = tracer_->snapshot();
  if (!now) return "begins";
  if (now->spp == 0) return fmt::format("coarse, 1/{}", now->coarseness);
  return now->noise ? fmt::format("{} samples a pixel, noise {:.2f} %", now->spp, 100.0 * *now->noise)
                    : fmt::format("{} samples a pixel", now->spp);
}

// The scenes are imported and edited on another thread. Until that is done, the old ones are traced.
void ReferenceView::followScene(const Session& session) {
  auto parts = partsOf(session);
  if (!parts) {
    error_ = parts.error();
    scene_key_.reset();  // once tracing is possible again, the scenes are read anew and the error is cleared
    return;
  }
  if (parts->empty()) return;  // nothing is shown yet
  SceneKey key{std::move(*parts), lampsOf(session), session.playback.time_s};
  if (coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    auto made = coming_.get();
    if (made) {
      scene_ = std::move(*made);
      error_.reset();
      eye_key_.reset();
    } else {
      error_ = made.error();
    }
  }
  if (scene_key_ == key || coming_.valid()) return;
  scene_key_ = key;
  coming_ = std::async(std::launch::async, [key = std::move(key)]() -> Result<ScenePointer> {
    try {
      auto made = makeReferenceScene(key.parts, key.lamps, key.animation_s);
      if (!made) return failAgain(made.error());
      return ScenePointer(std::make_shared<const baker::Scene>(std::move(*made)));
    } catch (const std::exception& failure) {
      return fail("reference", failure.what(), "free some memory");
    }
  });
}

void ReferenceView::followEye(const Session& session) {
  const EyeKey key{session.viewing.shown_view, session.viewing.size, session.stage.environment().version(),
                   spp, band_limit};
  const bool same = eye_key_ && sameView(eye_key_->view, key.view) &&
                    eye_key_->size.width == key.size.width && eye_key_->size.height == key.size.height &&
                    eye_key_->lights == key.lights && eye_key_->spp == key.spp &&
                    eye_key_->band_limit == key.band_limit;
  if (same) return;
  const bool new_scene = !eye_key_;
  eye_key_ = key;
  baker::reference::Request request;
  if (hasEditedKeys(session.stage.environment())) {
    if (edited_light_of_ != key.lights) edited_light_ = editedLight(session.stage.environment());
    edited_light_of_ = key.lights;
    request.more_light = edited_light_;
  } else {
    Sky sky = skyOf(session.stage);
    request.lights = std::move(sky.lights);
    request.light_factors = std::move(sky.factors);
  }
  for (spec::Light& shape : shapesOf(session)) request.lights.push_back(std::move(shape));
  request.view = key.view;
  request.options.size = key.size;
  request.options.spp = spp;
  request.options.rotate_light_deg = session.stage.environment().turnDegrees();
  if (band_limit) request.options.band_limit = baker::reference::BandLimit{.in = *band_limit, .out = {}};
  if (!tracer_)
    tracer_ = std::make_unique<baker::reference::ProgressiveReference>(scene_, std::move(request));
  else if (new_scene)
    tracer_->restart(scene_, std::move(request));
  else
    tracer_->restart(std::move(request));
  difference_.reset();
}

void ReferenceView::compared(Result<baker::Difference> difference) {
  if (difference)
    difference_ = std::move(*difference);
  else
    error_ = difference.error();
}

bool ReferenceView::update(const Session& session) {
  if (!on()) {
    tracer_.reset(), scene_.reset(), seen_.reset(), difference_.reset();
    scene_key_.reset(), eye_key_.reset(), error_.reset();
    return false;
  }
  if (session.scenes.entries().empty()) {
    error_ = Error{"reference", "there is no scene to trace", "open a .gltf or .glb file"};
    scene_key_.reset();
    return false;
  }
  followScene(session);
  if (!scene_) return false;
  followEye(session);
  return true;
}

}  // namespace lambent::editor
