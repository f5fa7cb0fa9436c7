// Tests lambent bake --watch as a user sees it: a line per event, bundles that follow their scenes, a clean
// end.
#include <thread>

#include <nlohmann/json.hpp>

#include "assets/scenes.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::bytesOf;
using testing::writeBytes;

class LambentWatch : public testing::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    std::filesystem::create_directories(scenes / "deep");
  }

  // Returns the events of a kind so far.
  std::vector<json> events(const std::string& kind) const {
    std::vector<json> found;
    std::istringstream lines(bytesOf(log("out")));
    for (std::string line; std::getline(lines, line);) {
      const json event = json::parse(line, nullptr, /*allow_exceptions=*/false);
      if (event.is_object() && event["event"] == kind) found.push_back(event);
    }
    return found;
  }
  bool waitFor(const std::string& kind, std::size_t count) const {
    return testing::eventually([&] { return events(kind).size() >= count; });
  }
  static std::string bytesOfScene(const std::filesystem::path& at, const assets::Scene& scene) {
    EXPECT_TRUE(assets::writeGlb(at, scene));
    return bytesOf(at);
  }

  std::filesystem::path scenes =
      std::filesystem::path(::testing::TempDir()) / fmt::format("{}-watched", ::getpid());
  void TearDown() override {
    std::filesystem::remove_all(scenes);
    ProgramTest::TearDown();
  }
};

}  // namespace

TEST_F(LambentWatch, BakesWhatIsThereAndWhatChangesAndKeepsTheOldBundleMeanwhile) {
  const std::string hello = bytesOfScene(folder / "hello", assets::hello());
  assets::Scene other = assets::hello();
  other.materials[0].base_color = {0.1f, 0.2f, 0.3f};
  const std::string changed = bytesOfScene(folder / "changed", other);
  const std::filesystem::path scene = scenes / "deep" / "a.glb", bundles = folder / "bundles",
                              bundle = bundles / "deep" / "a.lmb.glb";
  writeBytes(scene, hello);
  const ::pid_t watch =
      start(LAMBENT_PROGRAM, {"bake", "--watch", scenes.string(), "-o", bundles.string(), "--quality",
                              "draft", "--json", "--cache", (folder / "cache").string()});
  ASSERT_TRUE(waitFor("baked", 1)) << bytesOf(log("err"));
  EXPECT_TRUE(bundle::Reader::open(bundle));
  const std::string first = bytesOf(bundle);

  writeBytes(scene, changed.substr(0, changed.size() / 2));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_EQ(bytesOf(bundle), first) << "half a scene is no reason";
  EXPECT_EQ(events("baking").size(), 1u);
  writeBytes(scene, changed);
  ASSERT_TRUE(waitFor("baked", 2)) << bytesOf(log("err"));
  EXPECT_NE(bytesOf(bundle), first);
  EXPECT_EQ(events("baked")[1]["rays"], 0) << "a colour traces no ray";

  std::filesystem::remove(scene);
  ASSERT_TRUE(waitFor("removed", 1));
  EXPECT_TRUE(bundle::Reader::open(bundle)) << "a bundle outlives its scene";
  ::kill(watch, SIGINT);
  const testing::Outcome ended = finish(watch);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(events("ended").size(), 1u);
}

}  // namespace lambent
