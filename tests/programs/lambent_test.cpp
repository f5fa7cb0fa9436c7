// Tests lambent as a user sees it: exit codes, one-line errors, files that appear whole or not at all.

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "tests/programs/lambent_program.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::bytesOf;
using testing::expectOneLine;
using testing::kGallery;
using testing::kHello;
using testing::LambentProgram;
using testing::Outcome;
using testing::writeBytes;

TEST_F(LambentProgram, WrongUsageIsExitCode2AndOneLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"brew"},
      {"bake"},
      {"bake", "-o", path("a.lmb.glb")},
      {"bake", kHello, "-o"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--no-such-option"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--quality", "splendid"},
      {"reference", kHello, "-o", path("a.exr"), "--time", "soon"},
      {"reference", kHello, "-o", path("a.exr"), "--time", "-1"},
      {"reference", kHello, "-o", path("a.exr"), "--light", "sphere:0,0,0,-1,1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--rays", "-5"},
      {"bake", kHello, kHello, "-o", path("a.lmb.glb")},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--effects", "diffuse,smell"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--effects", ""},
      {"plan", kHello, "--effects", "smell"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-memory", "1"},
      {"plan"},
      {"info"},
      {"info", "a", "b"},
      {"view"},
      {"view", "a", "--port", "0"},
      {"view", "a", "--port", "65536"},
      {"compare", "a.exr"}};
  for (const auto& arguments : wrong) {
    const Outcome outcome = lambent(arguments);
    const std::string words = fmt::format("{}", fmt::join(arguments, " "));
    EXPECT_EQ(outcome.exit_code, 2) << words;
    expectOneLine(outcome, "lambent", words);
  }
  EXPECT_EQ(fileCount(), 0);
}

TEST_F(LambentProgram, NamesTheOptionOrCommandThatWasMeant) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> meant = {
      {{"bake", kHello, "-o", path("a.lmb.glb"), "--qualty", "draft"},
       "--qualty: is not an option; did you mean --quality?"},
      {{"bake", kHello, "-o", path("a.lmb.glb"), "--rasy=256"},
       "--rasy: is not an option; did you mean --rays?"},
      {{"info", "--jsno", "a"}, "did you mean --json?"},
      {{"bkae", kHello}, "bkae: is not a command; did you mean bake?"},
      {{"bake", kHello, "--splendid"}, "--splendid: is not an option; see lambent bake --help"},
      {{"bake", kHello, "--quality", "ultra"}, "ultra is neither draft nor standard nor high"}};
  for (const auto& [arguments, sentence] : meant) {
    const Outcome outcome = lambent(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << sentence;
    expectOneLine(outcome, "lambent", sentence);
    EXPECT_NE(outcome.err.find(sentence), std::string::npos) << outcome.err;
  }
}

TEST_F(LambentProgram, SaysWhenItsOutputIsLost) {
  ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
  for (const std::string& command :
       {"info " + path("hello.lmb.glb"), "plan --json " + kHello,
        "bake --json --force --quality draft -o " + path("a.lmb.glb") + " " + kHello}) {
    const Outcome lost = run("/bin/sh", {"-c", LAMBENT_PROGRAM " " + command + " > /dev/full"});
    EXPECT_EQ(lost.exit_code, 1) << command;
    expectOneLine(lost, "lambent", command);
    EXPECT_NE(lost.err.find("standard output: cannot be written"), std::string::npos) << lost.err;
  }
}

TEST_F(LambentProgram, RefusesAReferenceThatTakesTooMuchMemoryAndSaysHowMuchItTakes) {
  const auto referenceIn = [&](const std::string& memory, const std::string& size) {
    return lambent({"reference", kHello, "-o", path("a.exr"), "--spp", "1", "--size", size, "--max-memory",
                    memory, "--light", "constant:1,1,1", "--progress", "off", "--json"});
  };
  const Outcome refused = referenceIn("1GB", "16384x16384");
  EXPECT_EQ(refused.exit_code, 1);
  expectOneLine(refused, "lambent", "16384x16384");
  EXPECT_NE(refused.err.find("--max-memory: a picture of 16384 x 16384 takes about 34"), std::string::npos)
      << refused.err;
  EXPECT_EQ(fileCount(), 0);
  // What is said to be needed is enough, and not far too much.
  const Outcome needs = referenceIn("1MB", "1024x1024");
  EXPECT_EQ(needs.exit_code, 1);
  const std::size_t at = needs.err.find("takes about ");
  ASSERT_NE(at, std::string::npos) << needs.err;
  const double megabytes = std::stod(needs.err.substr(at + 12)) + 1.0;
  const Outcome enough = referenceIn(fmt::format("{:.0f}", 1e6 * megabytes), "1024x1024");
  ASSERT_EQ(enough.exit_code, 0) << enough.err;
  const double took = 1e-6 * json::parse(enough.out)["peakBytes"].get<double>();
#ifndef LAMBENT_SANITIZED  // AddressSanitizer keeps memory of its own
  EXPECT_LT(took, 1.1 * megabytes);
#endif
  EXPECT_GT(took, 0.5 * megabytes);
}

TEST_F(LambentProgram, ComparesPictures) {
  const std::string picture = LAMBENT_SOURCE_DIR "/tests/golden/hello_sky.exr";
  const Outcome same = lambent({"compare", picture, picture, "--reference2", picture, "--json"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(json::parse(same.out)["relativeRms"], 0.0);
  EXPECT_GT(json::parse(same.out)["pixels"], 1000);
  EXPECT_FALSE(json::parse(same.out).contains("sameSurface")) << "a picture without depths";
  EXPECT_EQ(fileCount(), 0);
  const Outcome heat = lambent({"compare", picture, picture, "--heat", path("heat.png")});
  EXPECT_EQ(heat.exit_code, 0) << heat.err;
  EXPECT_NE(heat.out.find("heat.png"), std::string::npos) << heat.out;
  EXPECT_TRUE(bytesOf(folder / "heat.png").starts_with("\x89PNG"));
  EXPECT_EQ(lambent({"compare", picture, picture, "--heat-range", "0"}).exit_code, 2);
  const Outcome lost = lambent({"compare", picture, path("lost.exr")});
  EXPECT_EQ(lost.exit_code, 1);
  expectOneLine(lost, "lambent", "lost.exr");
}

TEST_F(LambentProgram, BadInputIsExitCode1OneLineAndLeavesNoFile) {
  std::filesystem::create_directory(folder / "a-folder");
  writeBytes(folder / "words.glb", "Dear Sir or Madam,\nplease find the scene attached.\n");
  writeBytes(folder / "cut.glb", bytesOf(kHello).substr(0, 5000));
  writeBytes(folder / "empty.glb", "");
  writeBytes(folder / "scene.glb", bytesOf(kHello));
  const std::ptrdiff_t files = fileCount();
  struct Case {
    std::string named;  // stands in the line
    std::vector<std::string> arguments;
  };
  const std::string out = path("out.lmb.glb");
  const std::vector<Case> cases = {{"lost.glb", {"bake", path("lost.glb"), "-o", out}},
                                   {"a-folder", {"bake", path("a-folder"), "-o", out}},
                                   {"words.glb", {"bake", path("words.glb"), "-o", out}},
                                   {"cut.glb", {"bake", path("cut.glb"), "-o", out}},
                                   {"empty.glb", {"bake", path("empty.glb"), "-o", out}},
                                   {"no/such/out", {"bake", kHello, "-o", path("no/such/out.lmb.glb")}},
                                   {"a-folder", {"bake", kHello, "-o", path("a-folder")}},
                                   {"--max-edge", {"bake", kHello, "-o", out, "--max-edge", "1e-6"}},
                                   {"scene itself", {"bake", path("scene.glb"), "-o", path("scene.glb")}},
                                   {"lost.glb", {"plan", path("lost.glb")}},
                                   {"cut.glb", {"plan", path("cut.glb")}},
                                   {"lost.glb", {"info", path("lost.glb")}},
                                   {"a-folder", {"info", path("a-folder")}},
                                   {"words.glb", {"info", path("words.glb")}},
                                   {"hello.glb", {"info", kHello}},
                                   {"lost.glb", {"view", path("lost.glb")}},
                                   {"hello.glb", {"view", kHello}}};
  for (const Case& wrong : cases) {
    const Outcome outcome = lambent(wrong.arguments);
    const std::string words = fmt::format("{}", fmt::join(wrong.arguments, " "));
    EXPECT_EQ(outcome.exit_code, 1) << words;
    expectOneLine(outcome, "lambent", words);
    EXPECT_NE(outcome.err.find(wrong.named), std::string::npos) << words << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find("; "), std::string::npos) << "no mend: " << outcome.err;
  }
  EXPECT_EQ(fileCount(), files);
}

// A missing output folder must be reported before hours of tracing.
TEST_F(LambentProgram, LooksAtTheOutputAndTheOptionsBeforeTheRays) {
  for (const std::string& output : {path("no/such/out.lmb.glb"), folder.string()}) {
    const Outcome outcome =
        lambent({"bake", kGallery, "-o", output, "--quality", "high", "--rays", "1048576"});
    EXPECT_EQ(outcome.exit_code, 1);
    expectOneLine(outcome, "lambent", "the bake would first have said how long it takes");
  }
}

}  // namespace
}  // namespace lambent
