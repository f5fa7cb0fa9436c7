#include "editor/session/viewing.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "editor/session/session.hpp"
#include "runtime/scene/bounds.hpp"

namespace lambent::editor {

scene::Box Viewing::bounds(const Session& session) const {
  scene::Box box = scene::worldBounds(session.stage.world().registry());
  if (box.empty()) box.add(glm::vec3(-0.5f)), box.add(glm::vec3(0.5f));
  return box;
}

bool Viewing::hasAnimations(const Session& session) const {
  return session.document.registry().count<scene::AnimationComponent>() > 0;
}

// By the first camera of what was opened first, else so that all of it is seen.
void Viewing::placeFirst(Session& session) {
  if (size.width == 0 || scene::worldBounds(session.stage.world().registry()).empty()) return;
  frame_when_loaded = false;
  if (const auto names = cameras(session); !names.empty()) {
    if (setCamera(session, names.front())) {
      pose = goal;
      return;
    }
  }
  const scene::Box box = bounds(session);
  pose = goal = fromOrbit(spec::framingOrbit(box.min, box.max, glm::vec3(0.0f), size.aspect()), box);
}

void Viewing::update(Session& session, double seconds) {
  if (frame_when_loaded) placeFirst(session);
  if (!(pose == goal)) {
    pose = eased(pose, goal, static_cast<float>(seconds));
    changed = true;
  }
}

Result<spec::View> Viewing::view(const Session& session, spec::Size of) const {
  return viewOf(pose, bounds(session), of.aspect());
}

void Viewing::setView(Session& session, const frame::ViewChoice& choice) {
  view_ = choice;
  session.stage.frame().setView(choice);
  changed = true;
}

void Viewing::move(const Session& session, const CameraInput& input) {
  goal = pose = moved(pose, input, bounds(session));
  changed = true;
}

void Viewing::frame(const Session& session, const scene::Box& box) {
  goal = framed(goal, box.empty() ? bounds(session) : box, size.height > 0 ? size.aspect() : 1.0f);
  changed = true;
}

std::vector<std::string> Viewing::cameras(const Session& session) const {
  std::vector<std::string> names;
  for (const auto [entity, camera] : session.document.registry().view<const scene::CameraComponent>())
    names.push_back(session.document.nameOf(entity));
  return names;
}

Result<void> Viewing::setCamera(const Session& session, std::string_view word) {
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
    goal = fromOrbit(std::get<spec::OrbitCamera>(*parsed), bounds(session));
    return {};
  }
  const ecs::Registry& registry = session.document.registry();
  for (const auto [entity, camera] : registry.view<const scene::CameraComponent>()) {
    if (session.document.nameOf(entity) != word) continue;
    goal = fromNode(worldFromNode(registry, entity), camera, bounds(session));
    return {};
  }
  return fail("camera", fmt::format("there is no \"{}\"", word),
              fmt::format("give orbit:AZ,EL,DIST,FOV or one of: {}", fmt::join(cameras(session), ", ")));
}

void Viewing::tookTime(double ms, bool moves) {
  constexpr double kSlowMs = 150.0, kWantedMs = 80.0;
  constexpr float kLeast = 0.25f;
  if (!moving_fast_ && ms > kSlowMs)
    moving_scale_ = std::clamp(static_cast<float>(std::sqrt(kWantedMs / ms)), kLeast, 1.0f);
  if (!moving_fast_ && ms <= kSlowMs) moving_scale_ = 1.0f;
  moving_fast_ = moves && moving_scale_ < 1.0f;
}

void Viewing::settle() {
  if (moving_fast_) changed = true;
  moving_fast_ = false;
}

void Viewing::keep(WorldState& world) const {
  world.view["eye"] = poseWord(goal);
  world.view["shows"] = frame::wordOf(view_);
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

}  // namespace lambent::editor
