// Formats the editor's status: the window's title and the text at the right end of the menu bar.
#pragma once

#include <string>

namespace lambent::editor {

class Session;

// Returns for example "hello* - Lambent"; the asterisk means unsaved changes.
std::string titleOf(const Session& session);
// Returns for example "light settles   12.3 ms"; only the time is always present. What scenes lack is told by
// scene_status.hpp.
std::string pictureStatus(const Session& session);

}  // namespace lambent::editor
