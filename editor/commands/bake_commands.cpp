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
    enabled(
        &anyOpen,
        withWords("[SCENE]", 0, 1,
                  item("Bake", "bake", "Bake", "F7",
                       "Bake the scene at hand with what was edited; what did not change is not traced again",
                       &bake))),
    enabled(&anyOpen, item("Bake", "bake-all", "Bake all", "Shift+F7", "Bake all scenes with what was edited",
                           &bakeAll)),
    enabled(
        &baking,
        withWords("[SCENE]", 0, 1,
                  item("Bake", "cancel", "Cancel", "Ctrl+F7",
                       "Stop baking; what was done is kept, and the next bake goes on from there", &cancel))),
    enabled(
        &anyUnfinished,
        withWords("[SCENE]", 0, 1,
                  item("Bake", "go-on", "Go on with unfinished bakes", "",
                       "Finish bakes that an earlier session left unfinished, without opening their scenes",
                       &goOn))),
    withWords(
        "SCENE", 1, 1,
        item("Bake", "forget", "", "",
             "Give an unfinished bake of an earlier session up; what it kept stays in the cache", &forget)),
    withWords("NAME VALUE [SCENE]", 2, 3,
              item("Bake", "bake-option", "", "",
                   "An option of `lambent bake` for a scene, by its name without the dashes", &option)),
};

}  // namespace

std::span<const Command> bakeCommands() {
  return kBakeRows;
}

}  // namespace lambent::editor
