// Tests that changes of scenes and of the files that they name are reported once.
#include "baker/pipeline/source_watch.hpp"

#include <algorithm>

#include "tests/baker/pipeline/pipeline_test.hpp"

namespace lambent::baker {
namespace {

using WatchKind = WatchEvent::Kind;

class SourceWatchTest : public testing::PipelineTest {
 protected:
  static WatchSettings quick() {
    WatchSettings settings;
    settings.look_every = std::chrono::milliseconds(10);
    settings.still_for = std::chrono::milliseconds(60);
    return settings;
  }
  // Waits for the next event.
  std::optional<WatchEvent> next(SourceWatch& watch,
                                 std::chrono::milliseconds within = std::chrono::minutes(4)) {
    testing::eventually(
        [&] {
          for (WatchEvent& event : watch.takeEvents()) waiting_.push_back(std::move(event));
          return !waiting_.empty();
        },
        within);
    if (waiting_.empty()) return std::nullopt;
    WatchEvent first = std::move(waiting_.front());
    waiting_.erase(waiting_.begin());
    return first;
  }
  // Long enough to notice what must not come; how long a busy machine takes does not matter.
  static constexpr std::chrono::milliseconds kQuiet{250};

 private:
  std::vector<WatchEvent> waiting_;
};

// Writes a triangle with a buffer file of its own.
std::string gltfText(const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
             "buffers": [{"uri": ")" +
         buffer + R"(", "byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
             "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                            "min": [0, 0, 0], "max": [1, 1, 0]}]})";
}

}  // namespace

TEST_F(SourceWatchTest, ASceneIsToldOnceItWasStillForAMoment) {
  const std::filesystem::path file = folder / "hello.glb";
  writeBytes(file, "a");
  SourceWatch watch({folder}, quick());
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Found);
  EXPECT_EQ(event->scene, file);
  writeBytes(file, "more");
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Changed);
  EXPECT_FALSE(next(watch, kQuiet)) << "one change, one event";
}

TEST_F(SourceWatchTest, ABufferThatAFileNamesBelongsToTheScene) {
  const std::filesystem::path scene = folder / "a.gltf", buffer = folder / "tri angle.bin";
  writeBytes(scene, gltfText("tri%20angle.bin"));
  SourceWatch watch({folder}, quick());
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Found) << "even without its buffer";
  EXPECT_FALSE(next(watch, kQuiet));
  writeBytes(buffer, "twelve bytes");
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Changed);
  EXPECT_EQ(event->scene, scene);
}

TEST_F(SourceWatchTest, ARemovedSceneIsToldAndBundlesAndHiddenFilesAreNoScenes) {
  const std::string bytes = "a scene";
  std::filesystem::create_directories(folder / "deep" / "er");
  writeBytes(folder / "hello.lmb.glb", bytes);
  writeBytes(folder / ".hidden.glb", bytes);
  writeBytes(folder / "deep" / "er" / "hello.glb", bytes);
  SourceWatch watch({folder}, quick());
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->scene, folder / "deep" / "er" / "hello.glb");
  std::filesystem::remove(event->scene);
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Removed);
  EXPECT_FALSE(next(watch, kQuiet));
}

}  // namespace lambent::baker
