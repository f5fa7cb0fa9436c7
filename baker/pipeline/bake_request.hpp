// What somebody asked to be baked: a scene, the bundle to write, and how. Two requests for the same bundle
// are the same job, whatever else they say: requestKey() tells them by scene and output. Written as JSON into
// the journal (journal.hpp), so that a later run of the program can take it up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/import/import_options.hpp"
#include "baker/import/scene_edits.hpp"
#include "baker/pipeline/preview_levels.hpp"

namespace lambent::baker {

struct BakeRequest {
  std::filesystem::path scene, output;  // as given; the journal makes them absolute
  BakeOptions options{};
  ImportOptions import{};
  SceneEdits edits{};                       // to the scene, before it is baked
  PreviewLevel last = PreviewLevel::Final;  // at which the job is done
};

// Of both paths, absolute and without "." and "..": 16 hex digits, for names of files.
std::string requestKey(const BakeRequest& request);

std::string requestText(const BakeRequest& request);
// Nothing where the text is not a request of this program: of another version, damaged.
std::optional<BakeRequest> readRequest(const std::string& text);

}  // namespace lambent::baker
