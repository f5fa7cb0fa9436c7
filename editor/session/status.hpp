// Formats the editor's status: the window's title and the text at the right end of the menu bar.
#pragma once

#include <string>

namespace lambent::editor {

class Session;

// Returns for example "hello* - Lambent"; the asterisk means unsaved changes.
std::string titleOf(const Session& session);
// Returns for example "bakes: 1   light settles   12.3 ms"; only the time is always present.
std::string statusOf(const Session& session);

}  // namespace lambent::editor
