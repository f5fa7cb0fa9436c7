#include <algorithm>

#include "editor/commands/rows.hpp"

namespace lambent::editor {

std::span<const Command> commandList() {
  static const std::vector<Command> list = [] {
    std::vector<Command> all;
    for (const auto rows : {fileCommands(), assetCommands(), editCommands(), createCommands(), viewCommands(),
                            handleCommands(), cameraCommands(), lightCommands(), keyCommands(),
                            bakeCommands(), layoutCommands(), helpCommands(), stateCommands()})
      all.insert(all.end(), rows.begin(), rows.end());
    return all;
  }();
  return list;
}

const Command* findCommand(std::string_view id) {
  if (id.empty()) return nullptr;
  const auto list = commandList();
  const auto found = std::find_if(list.begin(), list.end(), [&](const Command& command) {
    return id == command.id || id == command.former;
  });
  return found == list.end() ? nullptr : &*found;
}

Result<nlohmann::json> runCommand(Session& session, std::string_view id, Words words) {
  const Command* command = findCommand(id);
  if (!command) return fail(std::string(id), "is no command", "\"commands\" lists them");
  if (words.size() < command->least_words && *command->title == '\0')
    return fail(std::string(id), "needs more words", fmt::format("{} {}", command->id, command->arguments));
  if (words.size() > command->most_words)
    return fail(std::string(id), "has too many words", fmt::format("{} {}", command->id, command->arguments));
  if (command->enabled && !command->enabled(session))
    return fail(std::string(id), "cannot be done now", command->help);
  try {
    return command->run(session, words);
  } catch (const std::exception& failure) {  // out of memory, mostly
    return fail(std::string(id), failure.what(), "");
  }
}

void runOrLog(Session& session, std::string_view id, Words words) {
  if (const auto done = runCommand(session, id, words); !done) session.log.error(done.error());
}

}  // namespace lambent::editor
