#include "runtime/base/own_program.hpp"

#include <system_error>

namespace lambent {

namespace fs = std::filesystem;

Result<fs::path> ownProgram() {
  std::error_code failed;
  fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return fail("/proc/self/exe", "does not name this program: " + failed.message());
  return program;
}

std::vector<fs::path> sampleFolders(const fs::path& program) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  const fs::path above = program.parent_path().parent_path();
  for (const char* place : {"share/lambent/scenes", "share/lambent/probes", "assets"})
    if (fs::is_directory(above / place, ignored)) folders.push_back(above / place);
  return folders;
}

}  // namespace lambent
