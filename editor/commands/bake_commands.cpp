#include <array>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

namespace {

Answer bake(Session& session, Words words) {
  const auto entry = findScene(session, words.empty() ? std::string() : words[0]);
  if (!entry) return failAgain(entry.error());
  return answerOf(session.scenes.bake(*entry, session.changes.editsOf(*entry)));
}

Answer bakeAll(Session& session, Words) {
  Result<void> first_failed;  // which keeps the others from nothing
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    if (session.scenes.entries()[i].source.empty()) continue;
    if (auto asked = session.scenes.bake(i, session.changes.editsOf(i)); !asked && first_failed)
      first_failed = std::move(asked);
  }
  return answerOf(first_failed);
}

Answer cancel(Session& session, Words words) {
  if (!words.empty()) {
    const auto entry = findScene(session, words[0]);
    if (!entry) return failAgain(entry.error());
    session.scenes.cancel(*entry);
    return nullptr;
  }
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) session.scenes.cancel(i);
  return nullptr;
}

Answer option(Session& session, Words words) {
  const auto entry = findScene(session, words.size() > 2 ? words[2] : std::string());
  if (!entry) return failAgain(entry.error());
  return answerOf(session.scenes.setOption(*entry, words[0], words[1]));
}

// Finds an unfinished bake by its scene's file name, or by its number.
Result<std::size_t> findUnfinished(const Session& session, const std::string& word) {
  const auto& unfinished = session.scenes.unfinished();
  for (std::size_t i = 0; i < unfinished.size(); ++i)
    if (unfinished[i].scene == word || unfinished[i].scene.filename() == word || std::to_string(i) == word)
      return i;
  return fail(word, "is no unfinished bake", "\"state\" lists them");
}

Answer goOn(Session& session, Words words) {
  if (words.empty()) {
    while (!session.scenes.unfinished().empty()) session.scenes.goOn(0);
    return nullptr;
  }
  const auto found = findUnfinished(session, words[0]);
  if (!found) return failAgain(found.error());
  session.scenes.goOn(*found);
  return nullptr;
}

Answer forget(Session& session, Words words) {
  const auto found = findUnfinished(session, words[0]);
  if (!found) return failAgain(found.error());
  session.scenes.forget(*found);
  return nullptr;
}

bool anyUnfinished(const Session& session) {
  return !session.scenes.unfinished().empty();
}

bool baking(const Session& session) {
  return session.scenes.busy();
}

constexpr std::array kBakeRows = {
    Command{.id = "bake",
            .title = "Bake",
            .menu = "Bake",
            .shortcut = "F7",
            .help = "Bake the scene at hand with what was edited; what did not change is not traced again",
            .arguments = "[SCENE]",
            .most_words = 1,
            .run = &bake,
            .enabled = &anyOpen},
    Command{.id = "bake-all",
            .title = "Bake all",
            .menu = "Bake",
            .shortcut = "Shift+F7",
            .help = "Bake all scenes with what was edited",
            .arguments = "",
            .run = &bakeAll,
            .enabled = &anyOpen},
    Command{.id = "cancel",
            .title = "Cancel",
            .menu = "Bake",
            .shortcut = "Ctrl+F7",
            .help = "Stop baking; what was done is kept, and the next bake goes on from there",
            .arguments = "[SCENE]",
            .most_words = 1,
            .run = &cancel,
            .enabled = &baking},
    Command{.id = "go-on",
            .title = "Go on with unfinished bakes",
            .menu = "Bake",
            .shortcut = "",
            .help = "Finish bakes that an earlier session left unfinished, without opening their scenes",
            .arguments = "[SCENE]",
            .most_words = 1,
            .run = &goOn,
            .enabled = &anyUnfinished},
    Command{.id = "forget",
            .title = "",
            .menu = "Bake",
            .shortcut = "",
            .help = "Give an unfinished bake of an earlier session up; what it kept stays in the cache",
            .arguments = "SCENE",
            .least_words = 1,
            .most_words = 1,
            .run = &forget},
    Command{.id = "bake-option",
            .title = "",
            .menu = "Bake",
            .shortcut = "",
            .help = "An option of `lambent bake` for a scene, by its name without the dashes",
            .arguments = "NAME VALUE [SCENE]",
            .least_words = 2,
            .most_words = 3,
            .run = &option},
};

}  // namespace

std::span<const Command> bakeCommands() {
  return kBakeRows;
}

}  // namespace lambent::editor
