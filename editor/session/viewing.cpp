#include "editor/session/viewing.hpp"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "runtime/scene/components.hpp"

namespace lambent::editor {

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
  world.view["shows"] = frame::wordOf(surfaces);
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
