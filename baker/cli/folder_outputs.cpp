#include "baker/cli/folder_outputs.hpp"

#include <fmt/format.h>

#include "baker/pipeline/source_watch.hpp"

namespace lambent::baker {

namespace fs = std::filesystem;

Result<fs::path> FolderOutputs::outputOf(const fs::path& scene) {
  fs::path output = bundleBeside(scene);
  if (!output_.empty())
    output =
        (output_ / scene.parent_path().lexically_relative(folder_)).lexically_normal() / output.filename();
  const auto [entry, added] = scene_of_.try_emplace(output, scene);
  if (!added && entry->second != scene)
    return fail(scene.string(),
                fmt::format("would be baked to {}, where {} is", output.string(), entry->second.string()),
                "rename one of them");
  std::error_code ignored;  // the bake reports that it cannot write
  fs::create_directories(output.parent_path(), ignored);
  return output;
}

void FolderOutputs::forget(const fs::path& scene) {
  std::erase_if(scene_of_, [&](const auto& entry) { return entry.second == scene; });
}

}  // namespace lambent::baker
