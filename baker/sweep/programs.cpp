#include "baker/sweep/programs.hpp"

#include <system_error>

namespace lambent::baker {

namespace {

constexpr const char* kSampleScene = "knot.glb";

}  // namespace

Result<Programs> findPrograms() {
  std::error_code failed;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed) return fail("lambent", "cannot find itself: " + failed.message());
  Programs programs{.lambent = self, .demo = self.parent_path() / "lambent-demo"};
  if (!std::filesystem::is_regular_file(programs.demo, failed))
    return fail(programs.demo.string(), "is missing, which draws the pictures that are measured",
                "build lambent-demo, or unpack the archive lambent-demo over this one");
  return programs;
}

Result<std::filesystem::path> findSampleScene(const Programs& programs) {
  const std::filesystem::path root = programs.lambent.parent_path().parent_path();
  std::error_code ignored;
  for (const char* folder : {"assets", "share/lambent/scenes"})
    if (const auto scene = root / folder / kSampleScene; std::filesystem::is_regular_file(scene, ignored))
      return scene;
  return fail(kSampleScene, "is not beside this program, and no other SCENE is named",
              "build the target assets, or name a scene");
}

}  // namespace lambent::baker
