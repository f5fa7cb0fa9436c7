// Tells how the scenes of the world differ from the bundles that are shown of them: as edits that a bake
// takes over, as sentences about what the picture only approximates until then, and as the baseline that
// "reset" goes back to. Reads the document and the scenes and changes neither. Main thread. Bundles that
// cannot stand beside each other are logged.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/import/scene_edits.hpp"
#include "editor/document/baseline.hpp"
#include "editor/document/history.hpp"
#include "editor/session/scenes.hpp"

namespace lambent::editor {

class SceneChanges {
 public:
  // All of them outlive it.
  SceneChanges(const frame::World& world, const Scenes& scenes, const History& history, Log& log)
      : world_(world), scenes_(scenes), history_(history), log_(log) {}

  // Returns how the bundles stand unedited.
  const Baseline& baseline();
  // Returns what of the entry's bundle differs from its scene's file, with the edits that it was baked with.
  baker::SceneEdits editsOf(std::size_t entry) const;
  // Returns a sentence for each edit of the entry that the picture only approximates until it is baked.
  std::vector<std::string> needsRebake(std::size_t entry) const;
  // Returns the same, but looks again only when edits or scenes have changed: for panels, which ask in every
  // frame.
  const std::vector<std::string>& needsRebakeNow(std::size_t entry);

 private:
  const frame::World& world_;
  const Scenes& scenes_;
  const History& history_;
  Log& log_;
  Baseline baseline_;
  // Version of the scenes, and the descriptions, that the baseline was made of.
  std::pair<std::uint64_t, std::vector<const void*>> baseline_of_{0, {}};
  struct Asked {
    std::size_t entry = 0;
    std::uint64_t edits = 0, scenes = 0;
    bool operator==(const Asked&) const = default;
  };
  std::optional<Asked> rebake_of_;
  std::vector<std::string> rebake_;
};

}  // namespace lambent::editor
