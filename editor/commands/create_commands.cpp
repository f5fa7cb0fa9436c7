#include <array>

#include "editor/commands/rows.hpp"
#include "editor/document/snapshot.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

// Creates the entity at the place that the words give, by default at the camera's target.
Answer put(Session& session, EntitySnapshot snapshot, Words words) {
  glm::vec3 at = session.viewing.goal.target_ws;
  for (int axis = 0; axis < 3 && !words.empty(); ++axis) {
    const auto number =
        words.size() == 3 ? spec::parseNumber(words[static_cast<std::size_t>(axis)]) : std::nullopt;
    if (!number) return fail("create", "is no place", "give three numbers, or none: where the eye looks");
    at[axis] = *number;
  }
  session.history.begin("create");
  const auto made = session.history.create(snapshot);
  if (!made) {
    session.history.cancel();
    return failAgain(made.error());
  }
  const auto moved = session.history.setField(*made, "Transform", "translation", at);
  session.history.commit();
  if (!moved) return failAgain(moved.error());
  const StableId id = session.document.idOf(*made);
  session.selection.set(id);
  return nlohmann::json{{"id", idText(id)}, {"name", session.document.nameOf(*made)}};
}

template <std::size_t Kind>
Answer light(Session& session, Words words) {
  constexpr std::array kKinds = {"point", "spot", "directional", "sphere", "disc"};
  return put(session, lightEntity(kKinds[Kind], freshName(session, kKinds[Kind])), words);
}
Answer camera(Session& session, Words words) {
  return put(session, cameraEntity(freshName(session, "camera")), words);
}
Answer empty(Session& session, Words words) {
  return put(session, emptyEntity(freshName(session, "empty")), words);
}

constexpr Command row(const char* id, const char* title, const char* help,
                      Result<nlohmann::json> (*run)(Session&, Words)) {
  return {.id = id,
          .title = title,
          .menu = "Create",
          .shortcut = "",
          .help = help,
          .arguments = "[X Y Z]",
          .most_words = 3,
          .run = run};
}

constexpr std::array kRows = {
    row("create-point", "Point light", "A lamp without size, where the eye looks", &light<0>),
    row("create-spot", "Spot light", "A lamp that shines along its -Z", &light<1>),
    row("create-directional", "Directional light", "Light from one direction, without end", &light<2>),
    row("create-sphere", "Sphere of light", "A lamp with a radius: soft shadows", &light<3>),
    row("create-disc", "Disc of light", "A flat lamp that shines to one side", &light<4>),
    separator("Create"),
    row("create-camera", "Camera", "A camera that stands in the world", &camera),
    row("create-empty", "Empty", "A place to hang other things from", &empty),
};

}  // namespace

std::span<const Command> createCommands() {
  return kRows;
}

}  // namespace lambent::editor
