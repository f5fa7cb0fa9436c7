// Writes the lines that tell at a glance what the editor has open and what it does: the window's title and
// the status at the right end of the menu bar.
#pragma once

#include <string>

namespace lambent::editor {

class Session;

// Returns "hello* - Lambent"; the asterisk means that something is not saved.
std::string titleOf(const Session& session);
// Returns "bakes: 1   light settles   12.3 ms", of which only the time is always there.
std::string statusOf(const Session& session);

}  // namespace lambent::editor
