// A BakeRequest says which scene to bake, into which bundle, and how. Two requests for the same scene and
// output are the same job, whatever else they say; requestKey() identifies them. Requests are written as JSON
// into the journal (journal.hpp), so that a later run of the program can resume them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/import/scene_edits.hpp"
#include "baker/import/gltf.hpp"

namespace lambent::baker {

// A scene gets better in preview levels: at once unshadowed, then coarse transfer, then what was asked for.
// Each is a complete bundle. Only this file decides with which options a level is baked.

enum class PreviewLevel : std::uint8_t {
  Unshadowed,  // traces no rays (bakeUnshadowed)
  Coarse,      // few rays, one bounce, no refinement; takes seconds
  Final        // the options that were asked for
};

const char* previewLevelName(PreviewLevel preview_level);  // "unshadowed", "coarse", "final"

// Returns the options of a level for a bake that asked for `asked`; they are never finer than those.
BakeOptions previewLevelOptions(PreviewLevel preview_level, const BakeOptions& asked);

// Bakes `scene` at one level, where `asked` holds the final options. Errors: those of bake().
Result<BakeReport> bakePreviewLevel(PreviewLevel preview_level, const Scene& scene, const BakeOptions& asked,
                                    const std::filesystem::path& output, const BakeContext& context);

struct BakeRequest {
  std::filesystem::path scene, output;  // as given; the journal makes them absolute
  BakeOptions options{};
  ImportOptions import{};
  SceneEdits edits{};                       // applied to the scene before it is baked
  PreviewLevel last = PreviewLevel::Final;  // the job is done at this level
};

// Returns the path made absolute and without "." and "..".
std::filesystem::path plainPath(const std::filesystem::path& path);

// Returns 16 hex digits, for file names, from plainPath() of both paths.
std::string requestKey(const BakeRequest& request);

std::string requestText(const BakeRequest& request);
// Returns nothing if the text is no request of this version of the program, or is damaged.
std::optional<BakeRequest> readRequest(const std::string& text);

}  // namespace lambent::baker
