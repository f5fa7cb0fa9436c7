// Tests `lambent bake DIR` as a user sees it: a line per scene, a summary, and an exit code that tells
// whether all scenes have their bundles; and what --quiet and --progress leave of what a bake says.
#include <nlohmann/json.hpp>

#include "tests/programs/lambent_program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::kHello;
using testing::LambentProgram;
using testing::Outcome;
using testing::writeBytes;

class LambentFolder : public LambentProgram {
 protected:
  void SetUp() override {
    LambentProgram::SetUp();
    std::filesystem::create_directories(folder / "scenes/deep");
    std::filesystem::copy(kHello, folder / "scenes/a.glb");
    std::filesystem::copy(kHello, folder / "scenes/deep/b.glb");
  }
  Outcome bakeAll(std::vector<std::string> options = {}) const {
    options.insert(options.begin(),
                   {"bake", path("scenes"), "-o", path("bundles"), "--quality", "draft", "--rays", "128"});
    return lambent(options);
  }
};

std::size_t lineCount(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_F(LambentFolder, BakesEverySceneOnceAndSumsUp) {
  const Outcome first = bakeAll();
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(lineCount(first.out), 3u) << first.out;
  EXPECT_NE(first.out.find("scenes/a.glb: "), std::string::npos) << first.out;
  EXPECT_NE(first.out.find("2 scenes: 2 baked, 0 up to date, 0 failed in "), std::string::npos) << first.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "bundles/a.lmb.glb"));
  EXPECT_TRUE(std::filesystem::exists(folder / "bundles/deep/b.lmb.glb")) << "folders below are mirrored";
  const Outcome second = bakeAll();
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(second.out.find("2 scenes: 0 baked, 2 up to date, 0 failed in "), std::string::npos)
      << second.out;
}

TEST_F(LambentFolder, GoesOnAfterAFailureAndFails) {
  writeBytes(folder / "scenes/0.glb", "no scene");
  std::filesystem::copy(kHello, folder / "scenes/a.gltf");  // another scene for a.lmb.glb
  const Outcome outcome = bakeAll({"--progress", "off"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(lineCount(outcome.err), 2u) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("lambent: " + path("scenes/0.glb") + ": ")) << outcome.err;
  EXPECT_NE(outcome.err.find("a.gltf: would be baked to "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("4 scenes: 2 baked, 0 up to date, 2 failed in "), std::string::npos)
      << outcome.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "bundles/deep/b.lmb.glb"));
}

TEST_F(LambentFolder, PrintsAnArrayAsJson) {
  writeBytes(folder / "scenes/0.glb", "no scene");
  const Outcome outcome = bakeAll({"--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  const json all = json::parse(outcome.out);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_FALSE(all[0]["error"].get<std::string>().empty());
  EXPECT_EQ(all[1]["scene"], path("scenes/a.glb"));
  EXPECT_EQ(all[1]["output"], path("bundles/a.lmb.glb"));
  EXPECT_GT(all[1]["rays"], 0);
  EXPECT_EQ(json::parse(bakeAll({"--json"}).out)[2]["upToDate"], true);
}

TEST_F(LambentFolder, QuietLeavesErrorsAndJson) {
  const Outcome one = bakeHello("hello.lmb.glb", {"--quiet"});
  EXPECT_EQ(one.exit_code, 0);
  EXPECT_EQ(one.out + one.err, "");
  EXPECT_EQ(bakeHello("hello.lmb.glb", {"-q"}).out, "") << "up to date";
  EXPECT_EQ(json::parse(bakeHello("hello.lmb.glb", {"-q", "--json"}).out)["upToDate"], true);
  writeBytes(folder / "scenes/0.glb", "no scene");
  const Outcome all = bakeAll({"--quiet"});
  EXPECT_EQ(all.exit_code, 1);
  EXPECT_EQ(all.out, "");
  EXPECT_EQ(lineCount(all.err), 1u) << all.err;
  const Outcome traced = lambent({"reference", kHello, "-o", path("a.exr"), "--size", "16x16", "--spp", "4",
                                  "--light", "constant:1,1,1", "--quiet"});
  EXPECT_EQ(traced.exit_code, 0);
  EXPECT_EQ(traced.out + traced.err, "");
}

TEST_F(LambentFolder, TellsProgramsHowFarItIs) {
  const Outcome outcome = bakeHello("hello.lmb.glb", {"--progress", "json", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0);
  std::istringstream lines(outcome.err);
  double share = 0.0;
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const json seen = json::parse(line);
    EXPECT_EQ(seen["scene"], kHello);
    EXPECT_FALSE(seen["stage"].get<std::string>().empty());
    EXPECT_GE(seen["share"], share);
    EXPECT_LE(seen["share"], 1.0);
    EXPECT_GE(seen["secondsLeft"], 0.0);
    share = seen["share"];
  }
  EXPECT_GE(count, 1u);
  EXPECT_EQ(bakeHello("b.lmb.glb", {"--progress", "off"}).err, "");
  EXPECT_EQ(bakeHello("b.lmb.glb", {"--progress", "smoke"}).exit_code, 2);
}

}  // namespace lambent
