// A BakeRequest says which scene to bake, into which bundle, and how. Two requests for the same scene and
// output are the same job, whatever else they say; requestKey() identifies them. Requests are written as JSON
// into the journal (journal.hpp), so that a later run of the program can resume them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/import/scene_edits.hpp"
#include "baker/import/scene_files.hpp"
#include "baker/pipeline/preview_levels.hpp"

namespace lambent::baker {

struct BakeRequest {
  std::filesystem::path scene, output;  // as given; the journal makes them absolute
  BakeOptions options{};
  ImportOptions import{};
  SceneEdits edits{};                       // applied to the scene before it is baked
  PreviewLevel last = PreviewLevel::Final;  // the job is done at this level
};

// Returns 16 hex digits, for file names, from both paths made absolute and without "." and "..".
std::string requestKey(const BakeRequest& request);

std::string requestText(const BakeRequest& request);
// Returns nothing if the text is no request of this version of the program, or is damaged.
std::optional<BakeRequest> readRequest(const std::string& text);

}  // namespace lambent::baker
