#include <array>

#include "editor/commands/rows.hpp"
#include "editor/document/document.hpp"
#include "editor/session/field_numbers.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

// Returns the place that the words give, or none without words.
Result<std::optional<glm::vec3>> placeOf(Words words) {
  if (words.empty()) return std::nullopt;
  glm::vec3 at(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const auto number =
        words.size() == 3 ? spec::parseNumber(words[static_cast<std::size_t>(axis)]) : std::nullopt;
    if (!number)
      return fail("create", "is no place", "give three numbers, or none: in front of what the camera sees");
    at[axis] = *number;
  }
  return at;
}

Answer create(Session& session, const EntitySnapshot& snapshot) {
  const auto made = session.history.create(snapshot);
  if (!made) return failAgain(made.error());
  const StableId id = session.document.idOf(*made);
  session.selection.set(id);
  return nlohmann::json{{"id", idText(id)}, {"name", session.document.nameOf(*made)}};
}

// Creates the entity at the place that the words give, or where a new light would stand.
Answer put(Session& session, const EntitySnapshot& snapshot, Words words) {
  const auto at = placeOf(words);
  if (!at) return failAgain(at.error());
  session.history.begin("creation of " + std::get<std::string>(*snapshot.find("Name", "name")));
  const auto made = create(session, snapshot);
  const ecs::Entity entity = session.selection.primaryEntity(session.document);
  const auto moved =
      made ? session.history.setField(entity, "Transform", "translation", at->value_or(newPlace(session)))
           : Result<void>();
  if (!made || !moved) {
    session.history.cancel();
    return failAgain(made ? moved.error() : made.error());
  }
  session.history.commit();
  return made;
}

template <scene::LocalLightComponent::Kind Kind>
Answer light(Session& session, Words words) {
  const auto at = placeOf(words);
  if (!at) return failAgain(at.error());
  const std::string word(scene::kLightKindWords[static_cast<std::size_t>(Kind)]);
  return create(session, newLight(session, Kind, freshName(session, word), *at));
}
Answer createCamera(Session& session, Words words) {
  return put(session, cameraEntity(freshName(session, "camera")), words);
}
Answer empty(Session& session, Words words) {
  return put(session, emptyEntity(freshName(session, "empty")), words);
}

constexpr Command row(const char* id, const char* title, const char* help,
                      Result<nlohmann::json> (*run)(Session&, Words)) {
  return withWords("[X Y Z]", 0, 3, item("Create", id, title, "", help, run));
}

using LampKind = scene::LocalLightComponent::Kind;

constexpr std::array kCreateRows = {
    row("create-point", "Point light", "A lamp without size, in front of what the camera sees",
        &light<LampKind::Point>),
    row("create-spot", "Spot light", "A lamp that shines along its -Z, at what the camera sees",
        &light<LampKind::Spot>),
    row("create-directional", "Directional light", "Light from one direction, without end",
        &light<LampKind::Directional>),
    row("create-sphere", "Sphere of light", "A lamp with a radius: soft shadows", &light<LampKind::Sphere>),
    row("create-disc", "Disc of light", "A flat lamp that shines to one side", &light<LampKind::Disc>),
    separator("Create"),
    row("create-camera", "Camera", "A camera that stands in the world", &createCamera),
    row("create-empty", "Empty", "A place to hang other things from", &empty),
};

}  // namespace

std::span<const Command> createCommands() {
  return kCreateRows;
}

}  // namespace lambent::editor
