// Reads and writes world files: which bundles a world has and how they were edited, as JSON
// (docs/world-file.md). A text or a path comes in and a checked WorldFile goes out. A file with an error is
// not used at all, and the error names the JSON path ("entities.0f3a….fields.Light.strength"). What this
// version does not know is reported and left out. Files are written atomically and in a stable order, so a
// small edit makes a small diff. To open a world: call loadWorldFile, open the bundles with the ids and
// instances that it names, call applyWorld.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/document.hpp"
#include "editor/document/overrides.hpp"
#include "runtime/base/result.hpp"
#include "runtime/scene/components.hpp"

namespace lambent::editor {

inline constexpr std::uint32_t kWorldFileVersion = 1;

struct WorldFile {
  WorldState state;
  scene::EnvironmentComponent environment;
  Overrides entities;
  std::vector<std::string> notices;  // a sentence for each part that was not understood
};

// subject: the name for error messages, e.g. the path.
Result<WorldFile> parseWorld(std::string_view text, const std::string& subject);
// Returns the text of the file. Errors: a value is not finite.
Result<std::string> worldText(const WorldFile& world);

// Reads and checks the file, but not whether its bundles exist.
Result<WorldFile> loadWorldFile(const std::filesystem::path& path);
Result<void> saveWorldFile(const std::filesystem::path& path, const WorldFile& world);

// Captures the document as it is now. `awaited`: edits of entities that do not exist at present, which are
// saved again.
WorldFile captureWorld(Document& document, const Baseline& baseline, const Overrides& awaited = {});
// Applies a world file, whose bundles must be in the registry already. It does not use the history; the
// caller clears it.
ApplyReport applyWorld(Document& document, const WorldFile& world);

}  // namespace lambent::editor
