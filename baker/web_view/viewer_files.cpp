#include "baker/web_view/viewer_files.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <glob.h>
#include <spawn.h>
#include <unistd.h>

#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {

namespace {

namespace fs = std::filesystem;

constexpr const char* kHint =
    "run npm ci in the folder web of Lambent's sources, and install or pack again where this is a package";

// Adds the files that a line of the list names; * stands for a part of a name, but not for folders. The
// address "viewer" of a folder "/usr/share/lambent/web/viewer" begins behind `web`.
Result<void> addMatches(const fs::path& web, const std::string& line, ServedFiles& files) {
  glob_t found = {};
  const int failed = ::glob((web / line).c_str(), 0, nullptr, &found);
  for (std::size_t i = 0; failed == 0 && i < found.gl_pathc; ++i) {
    const std::string file = found.gl_pathv[i];
    files[file.substr(web.string().size())] = file;
  }
  ::globfree(&found);
  if (failed != 0) return fail((web / line).string(), "is missing, which the viewer loads", kHint);
  return {};
}

}  // namespace

Result<ServedFiles> viewerFiles(const fs::path& web) {
  const fs::path list = web / "viewer/files.txt";
  const Result<std::string> text = readTextFile(list);
  if (!text) return fail(list.string(), "is missing, which lists the files of the viewer", kHint);
  ServedFiles files;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    if (const auto added = addMatches(web, line, files); !added) return failAgain(added.error());
  }
  return files;
}

Result<fs::path> findWebFolder() {
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return fail("lambent", "cannot find itself: " + failed.message());
  return self.parent_path().parent_path() / "share/lambent/web";
}

namespace {

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}

}  // namespace

bool openBrowser(const std::string& address) {
  // Without a display xdg-open would show text browsers in the terminal.
  if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY")) return false;
  std::string program = "xdg-open", word = address;
  const std::array<char*, 3> argv = {program.data(), word.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);  // this program waits for signals on a thread and has them blocked
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  ::pid_t id = -1;
  const bool started = ::posix_spawnp(&id, program.c_str(), &files, &attributes, argv.data(), environ) == 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return started;
}

}  // namespace lambent::baker
