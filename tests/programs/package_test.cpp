// Tests the package: the runtime alone, with its libraries, in a folder that can be anywhere.
#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using testing::bytesOf;
using testing::Outcome;

namespace fs = std::filesystem;

struct Library {
  std::string name, path;  // path: empty where it is not to be found
};

// Parses lines of ldd: "libfmt.so.9 => /lib/libfmt.so.9 (0x...)", "libdraco.so.7 => not found".
std::vector<Library> librariesOf(const std::string& ldd) {
  static const std::regex kLine(R"(^\s*(\S+) => (?:(/\S+)|not found))");
  std::vector<Library> out;
  std::istringstream lines(ldd);
  for (std::string line; std::getline(lines, line);)
    if (std::smatch found; std::regex_search(line, found, kLine)) out.push_back({found[1], found[2]});
  return out;
}

// Lists what a baker links and the runtime must not; static libraries leave their symbols' names.
std::vector<std::string> bakerPartsOf(const std::string& ldd, const fs::path& program) {
  static const std::regex kBakerLibrary("OpenImageIO|embree|tbb|opencv|gdal|meshoptimizer");
  std::vector<std::string> out;
  for (const Library& library : librariesOf(ldd))
    if (std::regex_search(library.name, kBakerLibrary)) out.push_back(library.name);
  const std::string bytes = bytesOf(program);
  for (const char* word : {"7lambent5baker", "7lambent6editor", "5ImGui", "Dear ImGui"})
    if (bytes.find(word) != std::string::npos) out.emplace_back(word);
  return out;
}

class Package : public testing::ProgramTest {
 protected:
  // Runs the program without this process's environment.
  Outcome bare(const fs::path& program, std::vector<std::string> arguments) const {
    std::vector<std::string> words = {"-i", "PATH=/usr/bin:/bin", program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run("/usr/bin/env", words);
  }
  std::string ldd(const fs::path& program) const { return bare("/usr/bin/ldd", {program.string()}).out; }

  // Packs `component` and unpacks it elsewhere; returns the folder in the archive.
  fs::path unpacked(const std::string& component) const {
    // No claim here depends on what the scene looks like.
    ::setenv("LAMBENT_PACKAGE_OPTIONS", "--quality draft --rays 128 --bounces 1 --refine off", 1);
    const fs::path packed = folder / "packed", there = folder / "there";
    const Outcome made = run(CPACK, {"--config", LAMBENT_BINARY_DIR "/CPackConfig.cmake", "-B",
                                     packed.string(), "-D", "CPACK_COMPONENTS_ALL=" + component});
    EXPECT_EQ(made.exit_code, 0) << made.out << made.err;
    std::vector<fs::path> archives;
    for (const auto& entry : fs::directory_iterator(packed))
      if (entry.path().string().ends_with(".tar.gz")) archives.push_back(entry.path());
    if (archives.size() != 1) {
      ADD_FAILURE() << archives.size() << " archives in place of one\n" << made.out;
      return {};
    }
    archive = archives[0];
    fs::create_directory(there);
    EXPECT_EQ(run("/usr/bin/tar", {"-xzf", archive.string(), "-C", there.string()}).exit_code, 0);
    fs::remove_all(packed / "_CPack_Packages");
    const auto first = fs::directory_iterator(there);
    return first == fs::directory_iterator() ? fs::path() : first->path();
  }

  mutable fs::path archive;
};

}  // namespace

TEST_F(Package, OfTheRuntimeRunsWhereItIsPutWithItsOwnLibraries) {
  const fs::path root = unpacked("runtime");
  ASSERT_FALSE(root.empty());
  EXPECT_TRUE(archive.filename().string().starts_with("lambent-demo-")) << archive;
  const fs::path demo = root / "bin/lambent-demo";
  EXPECT_FALSE(fs::exists(root / "bin/lambent"));

  // The system provides the C and C++ libraries, zlib and X11.
  static const std::regex kSystem(R"(^lib(c|m|dl|pthread|rt|stdc\+\+|gcc_s|z|X11|xcb|Xau|Xdmcp|bsd|md)\.so)");
  const auto libraries = librariesOf(ldd(demo));
  EXPECT_GT(libraries.size(), 10u);
  std::vector<std::string> used;
  for (const Library& library : libraries) {
    if (std::regex_search(library.name, kSystem)) continue;
    EXPECT_TRUE(library.path.starts_with(root.string()) ||
                fs::weakly_canonical(library.path).string().starts_with(fs::canonical(root).string()))
        << library.name << " => " << (library.path.empty() ? "not found" : library.path);
    used.push_back(library.name);
  }
  for (const auto& entry : fs::directory_iterator(root / "lib")) {
    const std::string name = entry.path().filename().string();
    EXPECT_NE(std::find(used.begin(), used.end(), name), used.end()) << name << " is for nobody";
    EXPECT_FALSE(std::regex_search(name, kSystem)) << name;
  }

  if (fs::exists("/usr/bin/help2man")) {
    EXPECT_NE(bytesOf(root / "share/man/man1/lambent-demo.1").find("\\-\\-headless"), std::string::npos);
  }
  EXPECT_TRUE(fs::exists(root / "share/bash-completion/completions/lambent-demo"));

  const fs::path notices = root / "share/doc/lambent";
  EXPECT_TRUE(fs::exists(notices / "LICENSE"));
  if (fs::exists("/usr/bin/dpkg-query")) {  // their licences: of a library, and of what is compiled in
    EXPECT_TRUE(fs::exists(notices / "runtime/libglm-dev.txt"));
    std::ifstream file(notices / "lambent-runtime.cdx.json");
    const auto materials = nlohmann::json::parse(file, nullptr, false);
    EXPECT_EQ(materials["bomFormat"], "CycloneDX");
    std::vector<std::string> names;
    for (const auto& component : materials["components"]) {
      EXPECT_FALSE(component["version"].get<std::string>().empty()) << component;
      names.push_back(component["name"]);
    }
    for (const char* name : {"libzstd1", "libglm-dev"})
      EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
    const auto draco = std::ranges::find_if(  // its number is the system's
        names, [](const std::string& name) { return std::regex_match(name, std::regex("libdraco[0-9]+")); });
    ASSERT_NE(draco, names.end());
    EXPECT_TRUE(fs::exists(notices / "runtime" / (*draco + ".txt")));
  }
  EXPECT_EQ(run("/bin/sh", {"-c", "cd \"$0\" && sha256sum -c \"$1\".sha256", archive.parent_path().string(),
                            archive.filename().string()})
                .exit_code,
            0);

  const Outcome version = bare(demo, {"--version"});
  EXPECT_EQ(version.exit_code, 0) << version.err;
  EXPECT_TRUE(version.out.starts_with("lambent-demo ")) << version.out;
  const fs::path picture = folder / "picture.png";
  const Outcome drawn =
      bare(demo, {(root / "share/lambent/scenes/" LAMBENT_PACKAGE_SCENE ".lmb.glb").string(), "--light",
                  (root / "share/lambent/probes/sky.hdr").string(), "--size", "160x90", "--headless",
                  picture.string()});
  if (testing::lacksDevice(drawn)) LAMBENT_LACKS("gl", drawn.err);
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_GT(fs::file_size(picture), 4000u) << "of one colour";
}

TEST_F(Package, OfTheRuntimeIsHardened) {
  const std::string elf = run("/usr/bin/readelf", {"-Whlds", LAMBENT_DEMO}).out;
  for (const char* mark : {"GNU_RELRO", "BIND_NOW", "Position-Independent Executable", "__stack_chk_fail"})
    EXPECT_NE(elf.find(mark), std::string::npos) << mark;
  EXPECT_TRUE(std::regex_search(elf, std::regex("__mem(cpy|set|move)_chk"))) << "no fortified call";
}

TEST_F(Package, OfTheRuntimeHasNothingOfTheBakerOrTheEditor) {
  const auto parts = bakerPartsOf(ldd(LAMBENT_DEMO), LAMBENT_DEMO);
  EXPECT_TRUE(parts.empty()) << parts[0];
  // The same check does find these parts in the baker and its module.
  auto of_lambent = bakerPartsOf(ldd(LAMBENT_PROGRAM), LAMBENT_PROGRAM);
  const fs::path module =
      fs::path(LAMBENT_PROGRAM).parent_path().parent_path() / "lib/liblambent-openimageio.so";
  for (const std::string& part : bakerPartsOf(ldd(module), module)) of_lambent.push_back(part);
  for (const char* part : {"libOpenImageIO.so", "libembree", "libtbb", "7lambent5baker"})
    EXPECT_TRUE(std::any_of(of_lambent.begin(), of_lambent.end(), [&](const std::string& name) {
      return name.find(part) != std::string::npos;
    })) << part;
}

}  // namespace lambent
