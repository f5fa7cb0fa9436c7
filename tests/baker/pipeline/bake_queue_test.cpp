// Tests that every preview level is a complete bundle, that the last one is what a plain bake writes, and
// that edits, cancels and failures on the way do no harm.
#include "baker/pipeline/bake_queue.hpp"

#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "runtime/bundle/container.hpp"
#include "tests/baker/pipeline/pipeline_test.hpp"

namespace lambent::baker {
namespace {

using testing::eventually;
using Kind = BakeEvent::Kind;

class BakeQueueTest : public testing::PipelineTest {
 protected:
  static BakeOptions quick() {
    BakeOptions options;
    options.quality = Quality::Draft;
    options.refine_bound = 0.0f;
    return options;
  }
  BakeRequest request(const std::string& name, const BakeOptions& options) const {
    return {.scene = folder / (name + ".glb"),
            .output = folder / (name + ".lmb.glb"),
            .options = options,
            .import = {}};
  }
  static JobState stateOf(const BakeQueue& queue, JobId job) {
    for (JobState& state : queue.states())
      if (state.id == job) return std::move(state);
    return {};
  }
  static bool isWhole(const std::filesystem::path& bundle) {
    const auto reader = bundle::Reader::open(bundle);
    return reader && reader->checkAll();
  }
  std::string diffuseBake(const BakeRequest& request) const {
    const auto scene = importScene(request.scene);
    Progress progress;
    const auto baked = bake(*scene, request.options, folder / "plain.lmb.glb", {progress});
    EXPECT_TRUE(baked) << baked.error().line();
    return bytesOf(folder / "plain.lmb.glb");
  }
};

// Returns the light that a sample receives, by a cell's only vector.
std::vector<float> vectorOf(const bundle::Reader& reader, std::uint32_t group, std::uint32_t cell) {
  const auto codes = reader.readCodebook(bundle::GroupIndex{group}, bundle::CellIndex{cell}, {});
  EXPECT_TRUE(codes);
  return transfer::decodeTransfer(reader.description().groups[group].cells[cell].transfers[0].shape,
                                  codes->codebook, codes->cluster_of, {});
}

}  // namespace

TEST_F(BakeQueueTest, TheUnshadowedRungHasNoSampleAtVerticesAndOneThatSeesEverythingInVolumes) {
  assets::Scene shown = assets::hello();
  shown.materials[0].specular = 1.0f;  // glossy
  shown.materials[0].roughness = 0.6f;
  shown.nodes.push_back({.name = "cloud",
                         .mesh = -1,
                         .translation = {0, 2, 0},
                         .volume = assets::Volume{.file = "procedural:cloud,1", .density_scale = 4.0f}});
  write(folder / "a.glb", shown);
  const auto scene = importScene(folder / "a.glb");
  ASSERT_TRUE(scene) << scene.error().line();
  Progress progress;
  const auto baked = bakeUnshadowed(*scene, quick(), folder / "a.lmb.glb", {progress});
  ASSERT_TRUE(baked) << baked.error().line();
  EXPECT_FALSE(isUpToDate(*scene, quick(), folder / "a.lmb.glb")) << "a bake must not take it for its own";
  const auto reader = bundle::Reader::open(folder / "a.lmb.glb");
  ASSERT_TRUE(reader) << reader.error().line();
  const auto checked = reader->checkAll();
  ASSERT_TRUE(checked) << checked.error().line();
  const bundle::Description& d = reader->description();
  for (std::uint32_t i = 0; i < d.draws.size(); ++i) {
    const auto rows = reader->readRows(i);
    ASSERT_TRUE(rows);
    EXPECT_TRUE(rows->samples.empty());
  }
  ASSERT_EQ(d.groups.size(), 2u);
  EXPECT_EQ(d.groups[0].cells[0].transfers[0].shape.order, 5u) << "the runtime takes the bands from here";
  const std::vector<float> in_cloud = vectorOf(*reader, 1, 0);
  EXPECT_NEAR(in_cloud[0], 0.28209479f, 1e-5f) << "the mean of the light";
  for (std::size_t i = 1; i < in_cloud.size(); ++i) EXPECT_NEAR(in_cloud[i], 0.0f, 1e-5f);
}

TEST_F(BakeQueueTest, RungsGetBetterAndEndWithWhatAPlainBakeWrites) {
  write(folder / "hello.glb", assets::hello());
  const BakeRequest asked = request("hello", quick());
  BakeQueue queue({.work_folder = folder / "work", .trial = std::chrono::milliseconds(0)});
  const JobId job = queue.add(asked);
  std::vector<BakeEvent> events;
  double fraction = 0.0;
  ASSERT_TRUE(eventually([&] {
    for (BakeEvent& event : queue.takeEvents()) {
      EXPECT_TRUE(event.kind != Kind::Bundle || isWhole(event.bundle)) << event.bundle;
      events.push_back(std::move(event));
    }
    const JobState state = stateOf(queue, job);
    EXPECT_GE(state.fraction, fraction - 1e-9);
    EXPECT_LE(state.fraction, 1.0);
    fraction = state.fraction;
    return state.phase == JobPhase::Done || state.phase == JobPhase::Failed;
  }));
  for (BakeEvent& event : queue.takeEvents()) events.push_back(std::move(event));
  ASSERT_EQ(events.size(), 3u);
  const PreviewLevel preview_levels[] = {PreviewLevel::Unshadowed, PreviewLevel::Coarse, PreviewLevel::Final};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(events[i].kind, Kind::Bundle);
    EXPECT_EQ(events[i].preview_level, preview_levels[i]);
  }
  EXPECT_EQ(events[2].bundle, asked.output);
  EXPECT_NE(events[1].bundle.parent_path(), asked.output.parent_path()) << "only the final one lies there";
  EXPECT_EQ(bytesOf(asked.output), diffuseBake(asked));
  EXPECT_EQ(stateOf(queue, job).fraction, 1.0);
}

TEST_F(BakeQueueTest, WhatIsUpToDateIsNotBakedAgain) {
  write(folder / "hello.glb", assets::hello());
  const BakeRequest asked = request("hello", quick());
  (void)diffuseBake(asked);
  std::filesystem::rename(folder / "plain.lmb.glb", asked.output);
  BakeQueue queue({.work_folder = folder / "work"});
  const JobId job = queue.add(asked);
  ASSERT_TRUE(eventually([&] { return !queue.busy(); }));
  const JobState state = stateOf(queue, job);
  EXPECT_EQ(state.phase, JobPhase::Done);
  EXPECT_TRUE(state.up_to_date);
  const auto events = queue.takeEvents();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].bundle, asked.output);
}

TEST_F(BakeQueueTest, AJobThatIsAddedAgainStartsWithTheNewContentUnderTheSameId) {
  write(folder / "a.glb", assets::knot());
  BakeOptions options = quick();
  options.rays = 4096;
  const BakeRequest asked = request("a", options);
  BakeQueue queue({.work_folder = folder / "work"});
  const JobId job = queue.add(asked);
  ASSERT_TRUE(eventually([&] { return stateOf(queue, job).phase == JobPhase::Baking; }));
  write(folder / "a.glb", assets::hello());
  BakeRequest again = asked;
  again.options = quick();
  EXPECT_EQ(queue.add(again), job);
  ASSERT_TRUE(eventually([&] { return !queue.busy(); }));
  EXPECT_EQ(stateOf(queue, job).phase, JobPhase::Done);
  EXPECT_EQ(bytesOf(asked.output), diffuseBake(again));
}

TEST_F(BakeQueueTest, ACancelledJobStopsAndLeavesTheOldBundle) {
  write(folder / "a.glb", assets::knot());
  BakeOptions options = quick();
  options.rays = 16384;
  const BakeRequest asked = request("a", options);
  writeBytes(asked.output, "old");
  BakeQueue queue({});  // without previews
  const JobId job = queue.add(asked);
  ASSERT_TRUE(eventually([&] { return stateOf(queue, job).stage.name == "direct light"; }));
  queue.cancel(job);
  EXPECT_EQ(stateOf(queue, job).phase, JobPhase::Cancelled);
  ASSERT_TRUE(eventually([&] { return !queue.busy(); }));
  EXPECT_EQ(stateOf(queue, job).phase, JobPhase::Cancelled);
  EXPECT_EQ(bytesOf(asked.output), "old");
}

}  // namespace lambent::baker
