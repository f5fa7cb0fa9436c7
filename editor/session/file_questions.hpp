// Asks for files: where dialogs begin, and under which name a world is saved. Another file of that name is
// not replaced before the user agrees. Main thread.
#pragma once

#include <filesystem>
#include <functional>

namespace lambent::editor {

class Session;

// Returns the folder in which dialogs begin: that of the world, of the scene that is open, or of what was
// opened last.
std::filesystem::path startFolder(const Session& session);
// Opens a dialog that asks for the world's file, saves it there, and then calls `then` if there is one.
// Nothing is called if the dialog is cancelled or the world cannot be saved, which is logged.
void askWhereToSave(Session& session, std::function<void(Session&)> then = {});

}  // namespace lambent::editor
