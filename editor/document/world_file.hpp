// Reads and writes world files: what stands in a world and how it was edited, as JSON (docs/world-file.md). A
// text or a path comes in, a checked value goes out. Nothing of a file that has an error is used, and errors
// name the place in it ("entities.0f3a….fields.Light.strength"). What this version does not know is kept and
// written back, and told. Writing is atomic and in a stable order: a small change is a small difference. The
// order of use: loadWorldFile, open the bundles with the ids and instances that it names, applyWorld.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "editor/document/baseline.hpp"
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
  UnknownFields unknown;             // by key at the top, and "environment/KEY"
  std::vector<std::string> notices;  // what was not understood but kept, a sentence each
};

// subject: what errors call it, e.g. the path.
Result<WorldFile> parseWorld(std::string_view text, const std::string& subject);
// Writes a world as text. Errors: a value that is not finite.
Result<std::string> worldText(const WorldFile& world);

// Reads the file and checks it, and that every bundle is there.
Result<WorldFile> loadWorldFile(const std::filesystem::path& path);
Result<void> saveWorldFile(const std::filesystem::path& path, const WorldFile& world);

// Return the file that a bundle's path means in a world file at `world_path`, and the path that a world file
// there has for a bundle.
std::filesystem::path resolvePath(const std::filesystem::path& world_path, std::string_view path);
std::string pathInWorld(const std::filesystem::path& world_path, const std::filesystem::path& file);
// Returns a light word with its environment map's path resolved likewise.
std::string resolveLight(const std::filesystem::path& world_path, const std::string& word);

// Takes the document as it is now. `kept` is what was loaded: its unknown parts are carried on.
WorldFile captureWorld(Document& document, const Baseline& baseline, const WorldFile* kept = nullptr);
// Applies a world file whose bundles stand in the registry. The document's history is not touched: clear it.
ApplyReport applyWorld(Document& document, const WorldFile& world);

}  // namespace lambent::editor
