#include <gtest/gtest.h>

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

}  // namespace lambent::gpu
