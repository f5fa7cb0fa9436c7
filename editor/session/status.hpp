// Says in one place what the picture of a scene is worth: whether it is being baked, needs a bake, misses
// its error bound, or is as good as was asked for. The tree, the status bar and the Bakes panel all show
// this, so that they never disagree. Also formats the window's title. Main thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace lambent::editor {

class Session;

// From the best to what concerns the user most.
enum class Standing : std::uint8_t { Good, Working, Wanting, Failed };

struct SceneStatus {
  Standing standing = Standing::Good;
  std::string text;    // "needs a rebake"; "up to date"
  std::string detail;  // sentences, one a line; may be empty
};

SceneStatus statusOf(Session& session, std::size_t entry);
// Returns the status of the scene that concerns the user most, with the scene's name in its text, or an empty
// text if all are good.
SceneStatus worstStatus(Session& session);

// Returns for example "hello* - Lambent"; the asterisk means unsaved changes.
std::string titleOf(const Session& session);
// Returns for example "light settles   12.3 ms"; only the time is always present.
std::string pictureStatus(const Session& session);

}  // namespace lambent::editor
