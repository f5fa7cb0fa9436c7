// Sets options of `lambent bake` by name, for scenes of the editor.
#include "baker/bake/bake.hpp"
#include "baker/bake/option_rows.hpp"
#include "editor/session/scenes.hpp"

namespace lambent::editor {

Result<void> Scenes::setOption(std::size_t index, std::string_view name, std::string_view word) {
  SceneEntry& entry = entries_[index];
  baker::BakeOptions options = entry.options;
  if (auto done = baker::putOption(options, name, word); !done) return done;
  if (auto checked = baker::checkRequest(options, entry.bundle); !checked) return checked;
  entry.options = options;
  return {};
}

}  // namespace lambent::editor
