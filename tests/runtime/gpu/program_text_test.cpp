#include <random>

#include <gtest/gtest.h>

#include "runtime/gpu/arena.hpp"
#include "runtime/gpu/program.hpp"

namespace lambent::gpu {
namespace {

std::string_view findText(std::string_view name) {
  if (name == "main.comp")
    return "#include \"math.glsl\"\n#include \"math.glsl\"\nvoid main() {\n  broken;\n}\n";
  if (name == "math.glsl") return "float one() {\n  return 1.0;\n}\n";
  if (name == "lost.comp") return "\n#include \"nowhere.glsl\"\n";
  return {};
}
constexpr FindText kTables[] = {&findText};

}  // namespace

TEST(ShaderText, PutsVersionAndDefinesFirstAndEachFileInOnce) {
  const Define defines[] = {{"LAMBENT_ORDER", "5"}};
  const auto shader = assembleShader("main.comp", {.tables = kTables, .defines = defines, .written = {}});
  ASSERT_TRUE(shader);
  EXPECT_EQ(shader->text,
            "#version 450 core\n#define LAMBENT_ORDER 5\nfloat one() {\n  return 1.0;\n}\nvoid main() {\n  "
            "broken;\n}\n");
}

TEST(ShaderText, MapsEveryDriversPositionsToFileAndLine) {
  const auto shader = assembleShader("main.comp", {.tables = kTables, .defines = {}, .written = {}});
  ASSERT_TRUE(shader);
  // Line 6 of the whole is line 4 of main.comp; line 3 is line 2 of math.glsl.
  EXPECT_EQ(mapLog("0:6(3): error: `broken' undeclared\n", *shader),
            "main.comp:4: error: `broken' undeclared");
  EXPECT_EQ(mapLog("0(3) : error C1503: undefined", *shader), "math.glsl:2: error C1503: undefined");
  EXPECT_EQ(mapLog("ERROR: 0:6: 'broken' : undeclared", *shader),
            "ERROR: main.comp:4: 'broken' : undeclared");
  EXPECT_EQ(mapLog("no position at all", *shader), "no position at all");
}

TEST(ShaderText, NamesTheLineThatIncludesAMissingFile) {
  const auto shader = assembleShader("lost.comp", {.tables = kTables, .defines = {}, .written = {}});
  ASSERT_FALSE(shader);
  EXPECT_EQ(shader.error().subject, "lost.comp:2");
  EXPECT_NE(shader.error().problem.find("nowhere.glsl"), std::string::npos);
}

TEST(FreeList, GivesDisjointPiecesAndMergesThemAllBack) {
  constexpr std::uint64_t kBytes = 1 << 16;
  FreeList list(kBytes);
  std::mt19937 random(7);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> held;
  std::vector<bool> taken(kBytes, false);
  for (int step = 0; step < 4000; ++step) {
    if (held.empty() || random() % 3 != 0) {
      const std::uint64_t size = 16 * (1 + random() % 64);
      const auto offset = list.allocate(size);
      if (!offset) continue;
      for (std::uint64_t i = *offset; i < *offset + size; ++i) {
        ASSERT_FALSE(taken[i]);
        taken[i] = true;
      }
      held.emplace_back(*offset, size);
    } else {
      std::swap(held[random() % held.size()], held.back());
      const auto [offset, size] = held.back();
      held.pop_back();
      list.release(offset, size);
      for (std::uint64_t i = offset; i < offset + size; ++i) taken[i] = false;
    }
    std::uint64_t used = 0;
    for (const auto& [offset, size] : held) used += size;
    ASSERT_EQ(list.freeBytes(), kBytes - used);
  }
  for (const auto& [offset, size] : held) list.release(offset, size);
  EXPECT_EQ(list.largestFree(), kBytes);
}

TEST(FreeList, RefusesWhatDoesNotFit) {
  FreeList list(64);
  EXPECT_FALSE(list.allocate(65));
  EXPECT_EQ(list.allocate(64), 0u);
  EXPECT_FALSE(list.allocate(1));
}

}  // namespace lambent::gpu
