#include "editor/session/samples.hpp"

#include <algorithm>
#include <string>

namespace lambent::editor {

std::vector<std::filesystem::path> sampleScenes(const std::filesystem::path& program) {
  std::vector<std::filesystem::path> scenes;
  std::error_code ignored;
  const std::filesystem::path above =
      std::filesystem::weakly_canonical(program, ignored).parent_path().parent_path();
  for (const char* place : {"share/lambent/scenes", "assets"})
    for (const auto& entry : std::filesystem::directory_iterator(above / place, ignored)) {
      const std::string name = entry.path().filename().string();
      if (entry.path().extension() == ".glb" && !name.ends_with(".lmb.glb")) scenes.push_back(entry.path());
    }
  std::ranges::sort(scenes);
  return scenes;
}

}  // namespace lambent::editor
