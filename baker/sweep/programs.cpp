#include "baker/sweep/programs.hpp"

#include <system_error>

#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

constexpr const char* kSampleScene = "knot.glb";

}  // namespace

Result<Programs> findPrograms() {
  const Result<std::filesystem::path> self = ownProgram();
  if (!self) return failAgain(self.error());
  Programs programs{.lambent = *self, .demo = self->parent_path() / "lambent-demo"};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(programs.demo, ignored))
    return fail(programs.demo.string(), "is missing, which draws the pictures that are measured",
                "build lambent-demo, or unpack the archive lambent-demo over this one");
  return programs;
}

Result<std::filesystem::path> findSampleScene() {
  std::error_code ignored;
  for (const std::filesystem::path& folder : sampleFolders())
    if (auto scene = folder / kSampleScene; std::filesystem::is_regular_file(scene, ignored)) return scene;
  return fail(kSampleScene, "is not beside this program, and no other SCENE is named",
              "build the target assets, or name a scene");
}

}  // namespace lambent::baker
