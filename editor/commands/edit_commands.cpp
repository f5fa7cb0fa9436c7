#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include "editor/commands/rows.hpp"
#include "editor/document/actions.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

bool anySelected(const Session& session) {
  return !session.selection.empty();
}

std::vector<ecs::Entity> selected(const Session& session) {
  return session.selection.entities(session.document);
}

void selectAll(Session& session, const std::vector<ecs::Entity>& entities) {
  std::vector<StableId> ids;
  for (const ecs::Entity entity : entities) ids.push_back(session.document.idOf(entity));
  session.selection.set(ids);
}

Answer replayed(Session& session, const Replay& replay) {
  for (const std::string& missing : replay.missing)
    session.log.warn(missing + " is not there now; it was passed over");
  return nlohmann::json{{"done", replay.done}, {"name", replay.name}, {"missing", replay.missing}};
}

Result<void> duplicateSelected(Session& session) {
  return duplicate(session.document, session.history, selected(session))
      .map([&](const std::vector<ecs::Entity>& copies) { selectAll(session, copies); });
}

Result<void> copy(Session& session) {
  return copyEntities(session.document, selected(session)).map([&](std::vector<EntitySnapshot> copies) {
    session.clipboard = std::move(copies);
  });
}

Result<void> paste(Session& session) {
  if (session.clipboard.empty())
    return fail("clipboard", "holds nothing that was copied here", "copy entities first");
  return pasteEntities(session.document, session.history, session.clipboard)
      .map([&](const std::vector<ecs::Entity>& pasted) { selectAll(session, pasted); });
}

Result<void> reset(Session& session, Words words) {
  const auto resetOne = [&](std::string_view component) {
    return resetToDefault(session.document, session.history, session.changes.baseline(), selected(session),
                          component, wordAt(words, 1));
  };
  if (!words.empty()) return resetOne(words[0]);
  session.history.begin("reset");
  for (const scene::ComponentInfo& component : scene::components())
    if (auto done = resetOne(component.name); !done) {
      session.history.cancel();
      return done;
    }
  session.history.commit();
  return {};
}

Answer everything(Session& session) {
  std::vector<StableId> ids;
  for (const TreeRow& row : session.tree.of(session.document))
    if (row.matches) ids.push_back(row.id);
  session.selection.set(ids);
  return ids.size();
}

// Takes names, ids or filters of the tree. The first match comes last, so that it is the primary one.
Answer select(Session& session, Words words) {
  std::vector<ecs::Entity> found;
  for (const std::string& word : words) {
    const auto entities = findEntities(session, word);
    if (!entities) return failAgain(entities.error());
    found.insert(found.begin(), entities->begin(), entities->end());
  }
  selectAll(session, found);
  return found.size();
}

Result<void> rename(Session& session, Words words) {
  const ecs::Entity primary = session.selection.primaryEntity(session.document);
  if (!words.empty()) return session.history.setField(primary, "Name", "name", words[0]);
  session.window.dialog = Dialog{
      .kind = Dialog::Kind::Text,
      .title = "Rename",
      .name = session.document.nameOf(primary),
      .answered = [](Session& s, const std::string& name) { runOrLog(s, "rename", std::array{name}); }};
  return {};
}

constexpr std::size_t kMostSelected = 1000;

}  // namespace

std::vector<Command> editCommands() {
  return inMenu(
      "Edit",
      {item("undo", "Undo", "Ctrl+Z", "Take the last step back",
            [](Session& session) { return replayed(session, session.history.undo()); })
           .onlyIf([](const Session& session) { return session.history.canUndo(); }),
       item("redo", "Redo", "Ctrl+Shift+Z", "Do again what was taken back",
            [](Session& session) { return replayed(session, session.history.redo()); })
           .onlyIf([](const Session& session) { return session.history.canRedo(); }),
       separator(), item("copy", "Copy", "Ctrl+C", "Copy what is selected", copy).onlyIf(anySelected),
       item("paste", "Paste", "Ctrl+V", "Paste what was copied at the top of the world", paste),
       item("duplicate", "Duplicate", "Ctrl+D", "Copies of what is selected, beside it", duplicateSelected)
           .onlyIf(anySelected),
       item("delete", "Delete", "Delete", "Take away what is selected; what a bundle brought stays",
            [](Session& session) { return session.history.destroy(selected(session)); })
           .onlyIf(anySelected),
       item("rename", "Rename...", "F2", "Another name for what is selected", rename)
           .taking("NAME", 1, 1)
           .onlyIf(anySelected),
       item("reset", "Reset to default", "Ctrl+R", "All fields of what is selected as the bundle has them",
            reset)
           .taking("[COMPONENT [FIELD]]", 0, 2)
           .onlyIf(anySelected),
       separator(), item("select-all", "Select all", "Ctrl+A", "All that the tree shows", everything),
       item("select-none", "Select none", "Ctrl+Shift+A", "Nothing is selected",
            [](Session& session) { session.selection.clear(); }),
       scripted("select",
                "Select by name, id (id:0123...) or search (type:light); the first named is the primary one",
                "NAME...", 1, kMostSelected, select)});
}

// Implements the commands that create entities, and decides where new lights stand and how bright they are.

namespace {

using LampKind = scene::LocalLightComponent::Kind;

constexpr float kShareOfWay = 0.35f;  // from the surface towards the camera
constexpr float kRadiusOfDistance = 0.1f;
constexpr float kOfWhite = 0.5f;  // what a white surface that faces the light is shown as
// A new directional light stands over the camera's shoulder, so that it lights what the camera sees and
// casts shadows to one side.
constexpr float kShoulderDeg = 40.0f, kHighDeg = 50.0f;

// Rounds to two digits, as a person would choose it.
float rounded(float value) {
  if (!(value > 0.0f) || !std::isfinite(value)) return value;
  const float step = std::pow(10.0f, std::floor(std::log10(value)) - 1.0f);
  return step * std::round(value / step);
}

glm::vec3 lookedAt(const Session& session) {
  const Viewing& viewing = session.viewing;
  return (viewing.surface_ahead ? viewing.surface_ahead() : std::nullopt).value_or(viewing.goal.target_ws);
}

// Returns the rotation that takes +Z, from where lights shine, to this direction.
glm::quat facing(float azimuth_deg, float elevation_deg) {
  return glm::angleAxis(glm::radians(azimuth_deg), glm::vec3(0.0f, 1.0f, 0.0f)) *
         glm::angleAxis(-glm::radians(elevation_deg), glm::vec3(1.0f, 0.0f, 0.0f));
}
glm::quat facing(const glm::vec3& direction) {
  return facing(glm::degrees(std::atan2(direction.x, direction.z)),
                glm::degrees(std::asin(std::clamp(direction.y, -1.0f, 1.0f))));
}

// Returns the strength at which a white surface at this distance, facing the light, is seen well.
float strengthFor(LampKind kind, float distance_m, float radius_m, float exposure_ev) {
  const float irradiance = std::numbers::pi_v<float> * kOfWhite * std::exp2(-exposure_ev);
  const float intensity = irradiance * distance_m * distance_m;
  if (kind == LampKind::Directional) return irradiance;
  if (kind == LampKind::Point || kind == LampKind::Spot) return intensity;
  return intensity / (std::numbers::pi_v<float> * radius_m * radius_m);
}

// Returns the point that a new entity gets: on the way from the surface in the middle of the picture to the
// camera, or the point that the camera turns about where there is no surface.
glm::vec3 newPlace(const Session& session) {
  const glm::vec3 surface = lookedAt(session);
  return surface + kShareOfWay * (session.viewing.goal.eye() - surface);
}

// Returns a light of this kind at `at`, or at newPlace() without it. It is turned towards the surface that
// the camera looks at, and as bright as the present exposure shows well, so that it is seen at once.
EntitySnapshot newLight(const Session& session, LampKind kind, std::string name,
                        const std::optional<glm::vec3>& at) {
  const glm::vec3 place = at.value_or(newPlace(session));
  const glm::vec3 back = place - lookedAt(session);
  const float distance = glm::length(back) > 0.0f ? glm::length(back) : 1.0f;
  const float radius = rounded(kRadiusOfDistance * distance);
  EntitySnapshot light = lightEntity(scene::kLightKindWords[static_cast<std::size_t>(kind)], std::move(name));
  light.put("Transform", "translation", place);
  if (kind == LampKind::Directional)
    light.put("Transform", "rotation", facing(session.viewing.goal.azimuth_deg + kShoulderDeg, kHighDeg));
  if (kind == LampKind::Spot || kind == LampKind::Disc)
    light.put("Transform", "rotation", facing(back / distance));
  if (kind == LampKind::Sphere || kind == LampKind::Disc) light.put("Light", "radius", radius);
  light.put("Light", "strength", rounded(strengthFor(kind, distance, radius, session.picture.exposure_ev)));
  return light;
}

// Returns the place that the words give, or none without words.
Result<std::optional<glm::vec3>> placeOf(Words words) {
  if (words.empty()) return std::nullopt;
  const auto numbers = spec::parseNumbers(fmt::format("{}", fmt::join(words, ",")));
  if (!numbers || numbers->size() != 3)
    return fail("create", "is no place", "give three numbers, or none: in front of what the camera sees");
  return glm::vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

Answer create(Session& session, const EntitySnapshot& snapshot) {
  const auto made = session.history.create(snapshot);
  if (!made) return failAgain(made.error());
  const StableId id = session.document.idOf(*made);
  session.selection.set(id);
  return nlohmann::json{{"id", idText(id)}, {"name", session.document.nameOf(*made)}};
}

Command lightOf(LampKind kind, const char* id, const char* title, const char* help) {
  return item(id, title, "", help,
              [kind](Session& session, Words words) -> Answer {
                const auto at = placeOf(words);
                if (!at) return failAgain(at.error());
                const std::string word(scene::kLightKindWords[static_cast<std::size_t>(kind)]);
                return create(session, newLight(session, kind, unusedName(session.document, word), *at));
              })
      .taking("[X Y Z]", 0, 3);
}

// The entity is created at the place that the words give, or where a new light would stand.
Command entityOf(EntitySnapshot (*make)(std::string), const char* id, const char* title, const char* stem,
                 const char* help) {
  return item(id, title, "", help,
              [make, stem](Session& session, Words words) -> Answer {
                const auto at = placeOf(words);
                if (!at) return failAgain(at.error());
                EntitySnapshot snapshot = make(unusedName(session.document, stem));
                snapshot.put("Transform", "translation", at->value_or(newPlace(session)));
                return create(session, snapshot);
              })
      .taking("[X Y Z]", 0, 3);
}

}  // namespace

std::vector<Command> createCommands() {
  return inMenu(
      "Create",
      {lightOf(LampKind::Point, "create-point", "Point light",
               "A lamp without size, in front of what the camera sees"),
       lightOf(LampKind::Spot, "create-spot", "Spot light",
               "A lamp that shines along its -Z, at what the camera sees"),
       lightOf(LampKind::Directional, "create-directional", "Directional light",
               "Light from one direction, without end"),
       lightOf(LampKind::Sphere, "create-sphere", "Sphere of light", "A lamp with a radius: soft shadows"),
       lightOf(LampKind::Disc, "create-disc", "Disc of light", "A flat lamp that shines to one side"),
       separator(),
       entityOf(&cameraEntity, "create-camera", "Camera", "camera", "A camera that stands in the world"),
       entityOf(&emptyEntity, "create-empty", "Empty", "empty", "A place to hang other things from")});
}

}  // namespace lambent::editor
