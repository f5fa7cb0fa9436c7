// Compares the scenes of the world with the bundles that are shown: it returns the edits for the next bake,
// sentences about what the picture only approximates until then, and the baseline for "reset". It reads the
// document and the scenes and changes neither. Main thread. Bundles that cannot be in one world (same id and
// instance) are logged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>

#include "baker/import/scene_edits.hpp"
#include "editor/document/history.hpp"
#include "editor/document/overrides.hpp"
#include "editor/session/scenes.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::editor {

// Returns whether two matrices describe the same placement, up to the rounding of matrices that were
// decomposed and composed again. All callers use this one rule, so that what is shown as moved is also an
// edit of the next bake. Translations may differ by 10 um, or by 10^-5 of the largest coordinate if that is
// beyond 1 m; the other entries may differ by 10^-5 of the largest of them.
bool samePlace(const glm::mat4& a, const glm::mat4& b);

// Converts the present Transforms of a bundle's nodes to edits of the scene that it is baked from. A node
// that was reparented stays in its place in the scene's own tree, because its StableId is made from that
// path, and the bake moves it to its place in the world. That it follows its new parent is known to the
// editor and the world file only.
void addNodeEdits(const ecs::Registry& registry, const bundle::Description& description,
                  const scene::SceneInstance& instance, baker::SceneEdits& edits);

class SceneChanges {
 public:
  // All arguments must outlive it.
  SceneChanges(const frame::World& world, const Scenes& scenes, const History& history, Log& log)
      : world_(world), scenes_(scenes), history_(history), log_(log) {}

  const Baseline& baseline();
  // Returns the edits of the entry's scene: those that its bundle was baked with, and the new ones.
  baker::SceneEdits editsOf(std::size_t entry) const;
  // Returns a sentence for each edit of the entry that the picture only approximates until the next bake.
  std::vector<std::string> needsRebake(std::size_t entry) const;
  // Returns the same, but recomputes it only when edits or scenes have changed. Panels call it every frame.
  // The result is valid until the next call.
  const std::vector<std::string>& needsRebakeNow(std::size_t entry);

 private:
  const frame::World& world_;
  const Scenes& scenes_;
  const History& history_;
  Log& log_;
  Baseline baseline_;
  // The version of the scenes and the descriptions that the baseline was built from.
  std::pair<std::uint64_t, std::vector<const void*>> baseline_of_{0, {}};
  struct Rebake {
    // The versions that the sentences belong to; none: they are to be made anew.
    std::optional<std::pair<std::uint64_t, std::uint64_t>> of_edits_and_scenes;
    std::vector<std::string> sentences;
  };
  std::vector<Rebake> rebakes_;  // by entry
};

// Says in one place what the picture of a scene is worth: whether it is being baked, needs a bake, misses
// its error bound, or is as good as was asked for. The tree, the status bar and the Bakes panel all show
// this, so that they never disagree. Also formats the window's title. Main thread.

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
