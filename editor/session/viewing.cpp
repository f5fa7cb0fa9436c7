#include "editor/session/viewing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "editor/session/session.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/scene/transforms.hpp"

namespace lambent::editor {

void PictureScale::wholeTook(double milliseconds) {
  constexpr double kSlowMs = 150.0, kWantedMs = 80.0;
  constexpr float kLeast = 0.25f;
  moving_ = milliseconds > kSlowMs
                ? std::clamp(static_cast<float>(std::sqrt(kWantedMs / milliseconds)), kLeast, 1.0f)
                : 1.0f;
}

bool PictureScale::settle() {
  return std::exchange(coarse_, false);
}

namespace {

// Returns the world's bounds, or a box of 1 m where nothing is in it.
scene::Box boundsOf(const Document& document) {
  scene::Box box = scene::worldBounds(document.registry());
  if (box.empty()) box.add(glm::vec3(-0.5f)), box.add(glm::vec3(0.5f));
  return box;
}

std::vector<std::string> camerasOf(const Document& document) {
  std::vector<std::string> names;
  for (const auto [entity, camera] : document.registry().view<const scene::CameraComponent>())
    names.push_back(document.nameOf(entity));
  return names;
}

}  // namespace

// Places the camera where the first camera of the world stands, else so that all of the world is seen.
void Viewing::placeFirst(const Document& document) {
  if (scene::worldBounds(document.registry()).empty()) return;
  frame_when_loaded = false;
  if (const auto names = camerasOf(document); !names.empty()) {
    if (setCamera(document, names.front())) {
      pose = goal;
      return;
    }
  }
  const scene::Box box = boundsOf(document);
  pose = goal = fromOrbit(spec::framingOrbit(box.min, box.max, glm::vec3(0.0f), size.aspect()), box);
}

void Viewing::update(const Document& document, double seconds) {
  if (frame_when_loaded) placeFirst(document);
  if (!(pose == goal)) {
    pose = eased(pose, goal, static_cast<float>(seconds));
    changed = true;
  }
}

Result<spec::View> Viewing::view(const Document& document, spec::Size of) const {
  return viewOf(pose, boundsOf(document), of.aspect());
}

void Viewing::move(const Document& document, const CameraInput& input) {
  goal = pose = moved(pose, input, boundsOf(document));
  changed = true;
}

void Viewing::frame(const Document& document, const scene::Box& box) {
  goal = framed(goal, box.empty() ? boundsOf(document) : box, size.aspect());
  changed = true;
}

Result<void> Viewing::setCamera(const Document& document, std::string_view word) {
  changed = true;
  if (word.starts_with("pose:")) {
    const auto parsed = parsePose(word);
    if (!parsed) return failAgain(parsed.error());
    goal = *parsed;
    return {};
  }
  if (word.starts_with("orbit:")) {
    const auto parsed = spec::parseCamera(word);
    if (!parsed) return failAgain(parsed.error());
    goal = fromOrbit(std::get<spec::OrbitCamera>(*parsed), boundsOf(document));
    return {};
  }
  const ecs::Registry& registry = document.registry();
  for (const auto [entity, camera] : registry.view<const scene::CameraComponent>()) {
    if (document.nameOf(entity) != word) continue;
    goal = fromNode(worldFromNode(registry, entity), camera, boundsOf(document));
    return {};
  }
  return fail("camera", fmt::format("there is no \"{}\"", word),
              fmt::format("give orbit:AZ,EL,DIST,FOV or one of: {}", fmt::join(camerasOf(document), ", ")));
}

void Viewing::keep(WorldState& world) const {
  world.view["eye"] = poseWord(goal);
}

void Viewing::follow(const WorldState& world) {
  const auto eye = world.view.find("eye");
  if (eye == world.view.end() || eye->second == pose_followed_) return;
  pose_followed_ = eye->second;
  if (const auto parsed = parsePose(eye->second)) {
    pose = goal = *parsed;
    frame_when_loaded = false;
    changed = true;
  }
}

void SettingStudy::measureAll() {
  waiting_.clear();
  for (const frame::SettingRow& row : frame::settingRows())
    if (row.finest) waiting_.insert(waiting_.begin(), std::string(row.name));
}

void SettingStudy::update(Session& session) {
  if (waiting_.empty() || !session.atRest()) return;
  const frame::SettingRow* row = frame::findSetting(waiting_.back());
  waiting_.pop_back();
  const spec::Size whole = session.viewing.size;
  const spec::Size size{320, std::max(1u, 320 * whole.height / std::max(1u, whole.width))};
  Stage& stage = session.stage;
  auto cost = frame::measureSetting({stage.world(), stage.environment(), session.viewing.shown_view},
                                    stage.settings(), *row, {.size = size, .repeats = 3});
  if (cost)
    costs_[std::string(row->name)] = std::move(*cost);
  else
    session.log.error(cost.error());
  session.viewing.changed = true;
}

ecs::Entity selectedCamera(const Session& session) {
  const ecs::Registry& registry = session.document.registry();
  const ecs::Entity entity = session.selection.primaryEntity(session.document);
  const bool camera = registry.alive(entity) && registry.has<scene::CameraComponent>(entity) &&
                      registry.has<scene::Transform>(entity);
  return camera ? entity : ecs::Entity{};
}

void lookThrough(Session& session, ecs::Entity camera) {
  const ecs::Registry& registry = session.document.registry();
  session.viewing.goal = fromNode(worldFromNode(registry, camera),
                                  registry.get<scene::CameraComponent>(camera), scene::worldBounds(registry));
  session.viewing.changed = true;
}

Result<void> placeAtView(Session& session, ecs::Entity camera) {
  const ecs::Registry& registry = session.document.registry();
  const CameraPose& pose = session.viewing.goal;
  const ecs::Entity parent = parentOf(registry, camera);
  const glm::mat4 world_from_parent =
      registry.alive(parent) ? worldFromNode(registry, parent) : glm::mat4(1.0f);
  scene::Transform to = registry.get<scene::Transform>(camera);
  scene::setLocalMatrix(to, glm::inverse(world_from_parent) * nodeMatrix(pose));
  std::vector<FieldEdit> edits = transformEdits(camera, to);
  edits.insert(edits.end(), {{camera, "Camera", "perspective", !pose.orthographic},
                             {camera, "Camera", "yfov", glm::radians(pose.fov_deg)},
                             {camera, "Camera", "ymag", pose.halfHeight()},
                             {camera, "Camera", "xmag", pose.halfHeight() * session.viewing.size.aspect()}});
  return session.history.setFields(edits, "place of " + session.document.nameOf(camera));
}

}  // namespace lambent::editor
