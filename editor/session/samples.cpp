#include "editor/session/samples.hpp"

namespace lambent::editor {

std::vector<std::filesystem::path> sampleFolders(const std::filesystem::path& program) {
  std::vector<std::filesystem::path> folders;
  std::error_code ignored;
  const std::filesystem::path above =
      std::filesystem::weakly_canonical(program, ignored).parent_path().parent_path();
  for (const char* place : {"share/lambent/scenes", "share/lambent/probes", "assets"})
    if (std::filesystem::is_directory(above / place, ignored)) folders.push_back(above / place);
  return folders;
}

}  // namespace lambent::editor
