#include "baker/web_view/viewer_files.hpp"

#include <sstream>
#include <system_error>

#include <glob.h>

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

}  // namespace lambent::baker
