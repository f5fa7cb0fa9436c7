// Keeps the promise of docs/library.md, "What stays the same": what programs that were linked against the
// libraries rely on, the functions by their mangled names and the sizes of structs, stands in abi/. Other
// symbols are left out, such as instances of the standard library's templates, which differ by compiler.
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <cxxabi.h>

#include "lambent/bake.hpp"
#include "lambent/bundle.hpp"
#include "lambent/renderer.hpp"
#include "lambent/scene.hpp"
#include "lambent/sh.hpp"
#include "lambent/version.hpp"
#include "tests/support/program.hpp"

namespace lambent {
namespace {

namespace fs = std::filesystem;
using Lines = std::set<std::string>;

#define SIZE(type) "size " #type " " + std::to_string(sizeof(type))

const std::map<std::string, Lines> kSizes = {
    {"lambent-sh", {SIZE(Vec3), SIZE(Box), SIZE(Failure), SIZE(Expected<void>), SIZE(LightVector)}},
    {"lambent-runtime",
     {SIZE(TransferBlock), SIZE(GroupInfo), SIZE(SurfaceInfo), SIZE(SurfaceData), SIZE(Bundle), SIZE(Camera),
      SIZE(Target), SIZE(PassTime), SIZE(Renderer), SIZE(Light), SIZE(LightId), SIZE(BodyId), SIZE(BundleId),
      SIZE(Body), SIZE(Scene)}},
    {"lambent-baker", {SIZE(BakeMesh), SIZE(BakeScene), SIZE(BakeProgress), SIZE(BakeResult), SIZE(Baker)}}};

// Returns what a list is of. While LAMBENT_ABI is 0, the promise holds within a minor version only.
std::string promise() {
  const std::string version = LAMBENT_VERSION;
  return "ABI " + std::to_string(LAMBENT_ABI) +
         (LAMBENT_ABI == 0 ? " of " + version.substr(0, version.rfind('.')) : "");
}

std::string readable(const std::string& line) {
  int status = 0;
  char* name = abi::__cxa_demangle(line.c_str(), nullptr, nullptr, &status);
  std::string text = status == 0 ? line + "\n    " + name : line;
  std::free(name);
  return text;
}

std::string listed(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += "  " + readable(line) + "\n";
  return text;
}

Lines without(const Lines& some, const Lines& others) {
  Lines rest;
  std::ranges::set_difference(some, others, std::inserter(rest, rest.end()));
  return rest;
}

class LibraryAbi : public testing::ProgramTest, public ::testing::WithParamInterface<const char*> {
 protected:
  // Returns the names of our functions that a library shows.
  Lines functionsOf(const fs::path& library) const {
    const testing::Outcome shown =
        run("/bin/sh", {"-ec", "exec nm -D --defined-only --format=posix \"$0\"", library.string()});
    EXPECT_EQ(shown.exit_code, 0) << shown.err;
    Lines functions;
    std::istringstream lines(shown.out);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("_ZN7lambent") || line.starts_with("_ZNK7lambent"))
        functions.insert(line.substr(0, line.find(' ')));
    return functions;
  }
};

TEST_P(LibraryAbi, IsThatOfItsNumber) {
  const std::string name = GetParam(), list = "tests/programs/abi/" + name + ".txt";
  Lines now = functionsOf(LAMBENT_BINARY_DIR "/lib/lib" + name + ".so");
  ASSERT_FALSE(now.empty());
  now.insert(kSizes.at(name).begin(), kSizes.at(name).end());
  std::string text = promise() + "\n";
  for (const std::string& line : now) text += line + "\n";
  const fs::path found = fs::path(LAMBENT_BINARY_DIR) / "abi" / (name + ".txt");
  fs::create_directories(found.parent_path());
  testing::writeBytes(found, text);

  std::istringstream lines(testing::bytesOf(LAMBENT_SOURCE_DIR "/" + list));
  std::string number;
  std::getline(lines, number);
  Lines promised;
  for (std::string line; std::getline(lines, line);) promised.insert(line);
  const std::string replace = "replace " + list + " by " + found.string() + "\n";
  ASSERT_EQ(number, promise()) << "The number was raised: " << replace;
  const Lines gone = without(promised, now), added = without(now, promised);
  EXPECT_TRUE(gone.empty())
      << "Programs that were linked against " << number
      << " need these, which are gone or have another size:\n"
      << listed(gone)
      << "Bring them back; or raise LAMBENT_ABI in "
         "runtime/library/include/lambent/version.hpp (while it is 0, the minor version "
         "in CMakeLists.txt), say so in CHANGELOG.md, and "
      << replace;
  EXPECT_TRUE(added.empty()) << "These are new, and programs will rely on them:\n"
                             << listed(added) << "If they are meant to be public, " << replace
                             << "If not, take LAMBENT_API from them\n";
}

INSTANTIATE_TEST_SUITE_P(, LibraryAbi, ::testing::Values("lambent-sh", "lambent-runtime", "lambent-baker"),
                         [](const auto& library) {
                           return std::string(library.param).substr(sizeof("lambent-") - 1);
                         });

}  // namespace
}  // namespace lambent
