#include <gtest/gtest.h>

#include "runtime/gpu/arena.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/gpu/program.hpp"
#include "tests/support/gl_seam.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::gpu {
namespace {

std::string_view findText(std::string_view name) {
  if (name == "broken.comp") return "layout(local_size_x = 1) in;\nvoid main() {\n  undeclared = 1;\n}\n";
  if (name == "mark.comp")
    return R"(layout(local_size_x = 4) in;
struct WorkItem { uint record; uint first; };
layout(std430, binding = 0) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = 1) buffer Marks { uint marks[]; };
void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * 65535u;
  if (index >= work_count) return;
  WorkItem item = work[index];
  atomicAdd(marks[item.record + item.first + gl_LocalInvocationID.x], 1u);
}
)";
  return {};
}
constexpr FindText kTables[] = {&findText};

}  // namespace

using Device = testing::GpuTest;
using testing::FullGpu;

TEST_F(Device, IsRefusedWithoutTheFeaturesThatAreNeeded) {
  const testing::FewFeatures few;
  const Result<Context> refused = Context::createHeadless();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().problem.find("has 0 storage blocks in vertex shaders, 5 are needed"),
            std::string::npos)
      << refused.error().problem;
  context.reset();  // the other one has taken its place
}

// Asks for more than any GPU has.
TEST_F(Device, ThrowsWhereItHasNoMemory) {
  EXPECT_THROW(Buffer("large", std::size_t{1} << 46), OutOfMemory);
  const TextureDesc large{.format = GL_RGBA32F, .width = 16384, .height = 16384, .layers = 2048};
  EXPECT_THROW(Texture("large", large), OutOfMemory);
  const Buffer small("small", 16);
  EXPECT_EQ(small.byteCount(), 16u);
  context.reset();  // both errors were meant
}

TEST_F(Device, AnArenaWithoutMemoryFailsAndGoesOnOnceThereIsSome) {
  Arena arena("test", FullGpu::kRefusedBytes);
  {
    const FullGpu full;
    const auto refused = arena.allocate(3000);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().subject, "GPU");
    EXPECT_EQ(refused.error().problem, "has no memory for test page 0, 1048576 bytes");
    EXPECT_FALSE(arena.allocate(3000, 6000));
    EXPECT_EQ(arena.bytesUsed(), 0u);
  }
  const auto allocated = arena.allocate(3000);
  ASSERT_TRUE(allocated);
  EXPECT_EQ(allocated->page, 0u);
}

TEST_F(Device, BytesThatCannotBeStagedThrowAndStagingGoesOnOnceTheyCan) {
  Staging staging;
  const Buffer buffer("test", 4096, WrittenBy::Gpu);
  const std::vector<std::uint32_t> ones(1024, 1);
  {
    const FullGpu full;
    EXPECT_THROW(staging.write(buffer, 0, std::as_bytes(std::span(ones))), OutOfMemory);
  }
  context->errors();  // of mapping what has no memory
  staging.write(buffer, 0, std::as_bytes(std::span(ones)));
  std::vector<std::uint32_t> back(ones.size());
  buffer.read(0, std::span(back));
  EXPECT_EQ(back, ones);
  context.reset();
}

TEST_F(Device, SaysThatItsContextIsLost) {
  const testing::LostContext lost;
  const Result<void> kept = checkContext();
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().problem,
            "has lost all that was drawn: its driver reset it because of another program");
}

TEST_F(Device, NamesFileAndLineOfAShaderThatDoesNotCompile) {
  const auto program = Program::create("broken", {{GL_COMPUTE_SHADER, "broken.comp"}}, kTables);
  ASSERT_FALSE(program);
  EXPECT_EQ(program.error().subject, "broken.comp");
  EXPECT_NE(program.error().problem.find("broken.comp:3"), std::string::npos) << program.error().problem;
  context.reset();  // drivers count the compiler's errors too
}

TEST_F(Device, RunsEveryWorkItemOnceAlsoBeyondOneRowOfGroups) {
  const auto program = Program::create("mark", {{GL_COMPUTE_SHADER, "mark.comp"}}, kTables);
  ASSERT_TRUE(program) << program.error().line();
  constexpr std::uint32_t kElements = 4 * 70'000;  // more than 65,535 groups of 4
  Buffer marks("marks", 4 * (kElements + 4));
  glClearNamedBufferData(marks.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  WorkList list("work");
  list.add({0}, 0, kElements, 4);
  list.add({1}, kElements, 4, 4);
  Counters counters;
  list.upload(counters);
  const std::uint64_t uploaded = counters.uploaded_bytes;
  list.upload(counters);
  EXPECT_EQ(counters.uploaded_bytes, uploaded) << "an unchanged list is not uploaded again";
  program->use();
  marks.bindStorage(1);
  list.dispatch(0, 0, counters);
  list.dispatch(1, 0, counters);
  EXPECT_EQ(counters.dispatches, 2u);
  std::vector<std::uint32_t> result(kElements + 4);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  marks.read(0, std::span(result));
  EXPECT_EQ(std::count(result.begin(), result.end(), 1u), static_cast<std::ptrdiff_t>(result.size()));
}

TEST_F(Device, ArenaKeepsWhatItIsGivenAndOpensPagesAsNeeded) {
  Arena arena("test", 4096);
  const auto first = arena.allocate(3000), second = arena.allocate(3000);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->page, 0u);
  EXPECT_EQ(second->page, 1u);
  const std::vector<std::uint32_t> values = {1, 2, 3, 4};
  arena.write(*second, 16, std::as_bytes(std::span(values)));
  std::vector<std::uint32_t> back(4);
  arena.page(1).read(second->offset + 16, std::span(back));
  EXPECT_EQ(back, values);
  arena.clear(*second);
  arena.page(1).read(second->offset + 16, std::span(back));
  EXPECT_EQ(back, std::vector<std::uint32_t>(4, 0));
  arena.release(*first);
  EXPECT_EQ(arena.allocate(4000)->page, 0u);
  EXPECT_FALSE(arena.allocate(Arena::kMaxPageBytes + 1));
}

TEST_F(Device, BytesThatAreStagedArriveWhereAndInWhichOrderTheyWereWritten) {
  Staging staging(4096);  // in parts of 256 bytes: what follows goes round it many times
  const Buffer buffer("test", 20'000, WrittenBy::Gpu);
  std::vector<std::uint32_t> values(5000), back(5000);
  for (std::uint32_t round = 0; round < 3; ++round) {
    for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = round * 10'000 + i;
    staging.write(buffer, 0, std::as_bytes(std::span(values)));
    staging.write(buffer, 400, std::as_bytes(std::span(values).first(33)));  // over what went before
    std::copy_n(values.begin(), 33, values.begin() + 100);
    buffer.read(0, std::span(back));
    EXPECT_EQ(back, values);
  }
  const Buffer large("test", 5'000'000, WrittenBy::Gpu);
  const std::vector<std::uint32_t> ones(1'250'000, 1);
  Staging wide;
  wide.write(large, 0, std::as_bytes(std::span(ones)));
  wide.clear(large, 16, 4'000'000);
  std::vector<std::uint32_t> result(ones.size());
  large.read(0, std::span(result));
  EXPECT_EQ(std::count(result.begin(), result.begin() + 4, 1u), 4);
  EXPECT_EQ(std::count(result.begin() + 4, result.begin() + 1'000'004, 0u), 1'000'000);
  EXPECT_EQ(std::count(result.begin() + 1'000'004, result.end(), 1u), 249'996);
}

TEST_F(Device, TimesPassesWithoutLosingThem) {
  PassTimers timers;
  for (int frame = 0; frame < 6; ++frame) {
    timers.beginFrame();
    PassTimers::Scope scope(timers, "clear");
    scope.counters().draws = static_cast<std::uint32_t>(frame);
  }
  timers.finish();
  ASSERT_EQ(timers.latest().size(), 1u);
  EXPECT_EQ(timers.latest()[0].name, "clear");
  EXPECT_EQ(timers.latest()[0].counters.draws, 5u);
  EXPECT_GE(timers.latest()[0].gpu_ms, 0.0);
}

}  // namespace lambent::gpu
