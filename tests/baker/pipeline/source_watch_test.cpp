// Tests that a change is reported once the file is complete, and not before.
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
    // By default never, since a busy machine may write half a scene and the other half an hour later.
    settings.complain_after = std::chrono::hours(24);
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
  std::string sceneBytes(const assets::Scene& scene) const {
    write(folder / ".scene", scene);
    return bytesOf(folder / ".scene");
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

std::string triangleBytes(float height) {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, height, 0};
  return {reinterpret_cast<const char*>(positions), sizeof(positions)};
}

}  // namespace

TEST_F(SourceWatchTest, AHalfWrittenSceneIsToldOnlyOnceItIsWhole) {
  const std::string bytes = sceneBytes(assets::hello());
  const std::filesystem::path file = folder / "hello.glb";
  writeBytes(file, bytes);
  SourceWatch watch({folder}, quick());
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Found);
  EXPECT_EQ(event->scene, file);
  const std::string other = sceneBytes(assets::knot());
  for (const double share : {0.0, 0.001, 0.3, 0.9, 0.999}) {
    writeBytes(file, other.substr(0, static_cast<std::size_t>(share * static_cast<double>(other.size()))));
    EXPECT_FALSE(next(watch, kQuiet)) << share;
  }
  writeBytes(file, other);
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Changed);
  EXPECT_FALSE(next(watch, kQuiet)) << "one change, one event";
}

TEST_F(SourceWatchTest, WhatStaysBrokenIsToldOnceAndMendedIsToldAgain) {
  const std::filesystem::path file = folder / "hello.glb";
  const std::string bytes = sceneBytes(assets::hello());
  writeBytes(file, bytes.substr(0, bytes.size() / 2));
  WatchSettings settings = quick();
  settings.complain_after = std::chrono::milliseconds(300);
  SourceWatch watch({folder}, settings);
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Broken);
  ASSERT_TRUE(event->error);
  EXPECT_FALSE(next(watch, kQuiet));
  writeBytes(file, bytes);
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Found);
}

TEST_F(SourceWatchTest, ABufferThatAFileNamesBelongsToTheScene) {
  const std::filesystem::path scene = folder / "a.gltf", buffer = folder / "tri angle.bin";
  writeBytes(scene, gltfText("tri%20angle.bin"));
  SourceWatch watch({folder}, quick());
  EXPECT_FALSE(next(watch, kQuiet)) << "its buffer is not there yet";
  writeBytes(buffer, triangleBytes(1.0f).substr(0, 20));
  writeBytes(buffer, triangleBytes(1.0f));
  auto event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Found);
  EXPECT_FALSE(next(watch, kQuiet));
  writeBytes(buffer, triangleBytes(2.0f) + "    ");
  event = next(watch);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, WatchKind::Changed);
  EXPECT_EQ(event->scene, scene);
}

TEST_F(SourceWatchTest, ARemovedSceneIsToldAndBundlesAndHiddenFilesAreNoScenes) {
  const std::string bytes = sceneBytes(assets::hello());
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
