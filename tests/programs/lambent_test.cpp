// Tests lambent as a user sees it: exit codes, one-line errors, files that appear whole or not at all,
// figures.
#include <chrono>
#include <thread>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "runtime/bundle/description.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::bytesOf;
using testing::expectOneLine;
using testing::Outcome;
using testing::writeBytes;

const std::string kHello = LAMBENT_BINARY_DIR "/assets/hello.glb";
const std::string kGallery = LAMBENT_BINARY_DIR "/assets/gallery.glb";

class LambentProgram : public testing::ProgramTest {
 protected:
  Outcome lambent(const std::vector<std::string>& arguments) const { return run(LAMBENT_PROGRAM, arguments); }
  std::string path(const std::string& name) const { return (folder / name).string(); }

  // Bakes hello.glb at draft quality, with further options.
  Outcome bakeHello(const std::string& name, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"bake", kHello, "-o", path(name), "--quality", "draft"});
    return lambent(options);
  }
};

}  // namespace

TEST_F(LambentProgram, HelpAndVersionAreExitCode0) {
  const Outcome version = lambent({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(version.out.starts_with("lambent ")) << version.out;
  const Outcome help = lambent({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"bake",
       {"SCENE",
        "--output",
        "--quality",
        "--order",
        "--rays",
        "--bounces",
        "--error",
        "--codes",
        "--max-edge",
        "--light-probes",
        "--refine",
        "--volume-grid",
        "--neighborhood-grid",
        "--effects",
        "--threads",
        "--max-memory",
        "--allow-outside",
        "--cache",
        "--cache-size",
        "--force",
        "--json"}},
      {"reference",
       {"SCENE", "--light", "--camera", "--output", "--spp", "--seed", "--band-limit", "--bounces", "--time",
        "--json"}},
      {"plan", {"SCENE", "--effects", "--light-probes", "--json"}},
      {"info", {"BUNDLE", "--json"}},
      {"accuracy",
       {"SCENE", "--output", "--quality", "--knob", "--light", "--camera", "--size", "--spp", "--force",
        "--json"}},
      {"compare",
       {"PICTURE", "REFERENCE", "--reference2", "--heat", "--heat-map", "--heat-range", "--json"}}};
  for (const auto& [command, options] : commands) {
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
    const Outcome about = lambent({command, "--help"});
    EXPECT_EQ(about.exit_code, 0) << command;
    EXPECT_EQ(about.err, "") << command;
    for (const std::string& option : options)
      EXPECT_NE(about.out.find(option), std::string::npos) << command << " " << option;
    EXPECT_EQ(lambent({command, "--version"}).out, version.out) << command;
  }
}

TEST_F(LambentProgram, WrongUsageIsExitCode2AndOneLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"brew"},
      {"bake"},
      {"bake", "-o", path("a.lmb.glb")},
      {"bake", kHello, "-o"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--no-such-option"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--quality", "splendid"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--order", "five"},
      {"reference", kHello, "-o", path("a.exr"), "--time", "soon"},
      {"reference", kHello, "-o", path("a.exr"), "--time", "-1"},
      {"reference", kHello, "-o", path("a.exr"), "--light", "sphere:0,0,0,-1,1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--rays", "-5"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--threads", "-1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-edge", "wide"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--refine", "2"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--volume-grid", "32x32"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--neighborhood-grid", "fine"},
      {"bake", kHello, kHello, "-o", path("a.lmb.glb")},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--effects", "diffuse,smell"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--effects", ""},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--order", "9"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--order", "-1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--rays", "5"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--rays", "1048577"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-edge", "-1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-edge", "nan"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-edge", "inf"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--error", "nan"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--error", "-0.1"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--error", "1"},
      {"plan", kHello, "--effects", "smell"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--rays", "0"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--threads", "0"},
      {"bake", kHello, "-o", path("a.lmb.glb"), "--max-memory", "1"},
      {"plan"},
      {"info"},
      {"info", "a", "b"},
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

TEST_F(LambentProgram, BakesBesideTheSceneUnlessToldWhere) {
  std::filesystem::copy(kHello, folder / "hello.glb");
  ASSERT_EQ(lambent({"bake", path("hello.glb"), "--quality", "draft"}).exit_code, 0);
  EXPECT_EQ(lambent({"info", path("hello.lmb.glb")}).exit_code, 0);
  // A bundle is a GLB file too, but not one to bake.
  const std::ptrdiff_t files = fileCount();
  for (const std::vector<std::string>& again :
       {std::vector<std::string>{"bake", path("hello.lmb.glb"), "-o", path("b.lmb.glb")},
        {"plan", path("hello.lmb.glb")}}) {
    const Outcome outcome = lambent(again);
    EXPECT_EQ(outcome.exit_code, 1);
    expectOneLine(outcome, "lambent", again.front());
    EXPECT_NE(outcome.err.find("is a bundle, which was baked already; name the scene"), std::string::npos);
  }
  EXPECT_EQ(fileCount(), files);
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

TEST_F(LambentProgram, DoesNotWaitForPipesInPlaceOfFiles) {
  const std::string pipe = path("pipe.hdr");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", pipe},
        {"plan", pipe},
        {"bake", pipe, "-o", path("a.lmb.glb")},
        {"compare", pipe, pipe},
        {"reference", kHello, "-o", path("a.exr"), "--light", pipe}}) {
    const Outcome outcome = lambent(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << arguments.front();
    expectOneLine(outcome, "lambent", arguments.front());
    EXPECT_NE(outcome.err.find("pipe.hdr: is a device or a pipe"), std::string::npos) << outcome.err;
  }
}

TEST_F(LambentProgram, ReportsAFileThatGrowsPastItsLimit) {
  const Outcome outcome = run("/bin/sh", {"-c", "ulimit -f 8; exec " LAMBENT_PROGRAM " bake " + kHello +
                                                    " --quality draft -o " + path("a.lmb.glb")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("a.lmb.glb: cannot be written: File too large"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(fileCount(), 0);
}

TEST_F(LambentProgram, BakesTheSameBytesWithAnyNumberOfThreads) {
  ASSERT_EQ(bakeHello("one.lmb.glb", {"--threads", "1"}).exit_code, 0);
  ASSERT_EQ(bakeHello("two.lmb.glb", {"--threads", "4000000000"}).exit_code, 0);
  ASSERT_GT(bytesOf(folder / "one.lmb.glb").size(), 1000u);
  EXPECT_TRUE(bytesOf(folder / "one.lmb.glb") == bytesOf(folder / "two.lmb.glb"));
  EXPECT_EQ(fileCount(), 2);
}

TEST_F(LambentProgram, BakesAgainOnlyWhenSomethingChangedOrForced) {
  const auto bundle = folder / "hello.lmb.glb";
  ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
  const auto long_ago = std::filesystem::last_write_time(bundle) - std::chrono::hours(1);
  std::filesystem::last_write_time(bundle, long_ago);
  const std::string before = bytesOf(bundle);

  const Outcome again = bakeHello("hello.lmb.glb");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_NE(again.out.find("up to date"), std::string::npos) << again.out;
  EXPECT_EQ(json::parse(bakeHello("hello.lmb.glb", {"--json"}).out)["upToDate"], true);
  EXPECT_EQ(std::filesystem::last_write_time(bundle), long_ago);

  EXPECT_EQ(bakeHello("hello.lmb.glb", {"--force"}).exit_code, 0);
  EXPECT_GT(std::filesystem::last_write_time(bundle), long_ago);
  EXPECT_TRUE(bytesOf(bundle) == before);

  EXPECT_EQ(bakeHello("hello.lmb.glb", {"--order", "3"}).exit_code, 0);
  EXPECT_FALSE(bytesOf(bundle) == before);
  // A damaged bundle is not up to date.
  std::string damaged = before;
  damaged[before.size() / 2] ^= 1;
  writeBytes(bundle, damaged);
  EXPECT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
  EXPECT_TRUE(bytesOf(bundle) == before);
}

TEST_F(LambentProgram, ReportsFiguresThatAddUpAsJson) {
  const Outcome baked = bakeHello("hello.lmb.glb", {"--refine", "off", "--json"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const json report = json::parse(baked.out);
  EXPECT_EQ(report["output"], path("hello.lmb.glb"));
  EXPECT_EQ(report["settings"]["rays"], "256");
  EXPECT_GT(report["raysPerSecond"], 0.0);
  EXPECT_EQ(report["fileBytes"], std::filesystem::file_size(folder / "hello.lmb.glb"));
  EXPECT_LE(report["codingError"], 0.01);
  EXPECT_LE(report["samples"], report["vertices"]);
  EXPECT_FALSE(report["stages"].empty());
  for (const json& stage : report["stages"]) EXPECT_GE(stage["seconds"], 0.0) << stage;

  const Outcome planned = lambent({"plan", kHello, "--json"});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const json plan = json::parse(planned.out);
  std::uint64_t vertices = 0, triangles = 0;
  for (const json& group : plan["groups"]) {
    vertices += group["vertices"].get<std::uint64_t>();
    triangles += group["triangles"].get<std::uint64_t>();
  }
  ASSERT_EQ(plan["effects"].size(), 4u);
  EXPECT_EQ(plan["effects"][0]["effect"], "diffuse");
  EXPECT_EQ(plan["effects"][0]["baked"], true);
  EXPECT_EQ(plan["effects"][1]["effect"], "glossy");
  EXPECT_EQ(plan["effects"][1]["baked"], false);
  EXPECT_EQ(plan["effects"][2]["effect"], "volume");
  EXPECT_EQ(plan["effects"][2]["baked"], false);
  EXPECT_EQ(plan["effects"][3]["effect"], "neighborhood");
  EXPECT_EQ(plan["effects"][3]["baked"], false);
  EXPECT_FALSE(plan["effects"][0]["reason"].get<std::string>().empty());
  ASSERT_EQ(plan["groups"][0]["primitives"].size(), 3u) << "floor, box and sphere";
  const auto expectDecided = [](const json& decisions) {
    ASSERT_FALSE(decisions.empty());
    for (const json& decision : decisions) {
      const auto word = decision["decision"].get<std::string>();
      EXPECT_TRUE(word == "baked" || word == "leftOut" || word == "absent" || word == "atRunTime") << word;
      EXPECT_FALSE(decision["reason"].get<std::string>().empty()) << decision;
      EXPECT_EQ(decision["saves"]["seconds"].is_null(), word != "absent")
          << "without --quality nobody has rehearsed: " << decision;
    }
  };
  expectDecided(plan["groups"][0]["decisions"]);
  for (const json& primitive : plan["groups"][0]["primitives"]) expectDecided(primitive["decisions"]);

  const Outcome told = lambent({"info", path("hello.lmb.glb"), "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const json info = json::parse(told.out);
  EXPECT_EQ(info["triangles"], triangles);
  EXPECT_EQ(info["triangles"], report["triangles"]);
  EXPECT_EQ(info["vertices"], report["vertices"]);
  EXPECT_LE(info["vertices"], vertices) << "coding joins equal vertices and adds none";
  EXPECT_EQ(info["fileBytes"], report["fileBytes"]);
  EXPECT_EQ(info["meshBytes"], report["meshBytes"]);
  EXPECT_EQ(info["imageBytes"], report["imageBytes"]);
  EXPECT_EQ(info["rowBytes"].get<int>() + info["codebookBytes"].get<int>() +
                info["clusterIdBytes"].get<int>() + info["planeBytes"].get<int>() +
                info["lightWeightBytes"].get<int>(),
            report["transferBytes"].get<int>());
  EXPECT_EQ(info["proxyBytes"], report["proxyBytes"]);
  EXPECT_EQ(info["settings"]["order"], "5");
  EXPECT_EQ(info["groups"].size(), plan["groups"].size());
  EXPECT_EQ(info["groups"][0]["samples"], report["samples"]);
  EXPECT_EQ(info["groups"][0]["lightSamples"], 1);
  EXPECT_EQ(report["groups"][0]["lightSamples"], 1);
  EXPECT_EQ(plan["groups"][0]["lightSamples"], 1);
  EXPECT_FALSE(plan["groups"][0]["lightSamplesReason"].get<std::string>().empty());
  EXPECT_GT(info["groups"][0]["proxyTriangles"][0], 0);
  EXPECT_EQ(info["groups"][0]["proxyTriangles"], report["groups"][0]["proxyTriangles"]);
  // The text output has the same figures.
  for (const auto& arguments : {std::vector<std::string>{"plan", kHello}, {"info", path("hello.lmb.glb")}}) {
    const Outcome words = lambent(arguments);
    EXPECT_EQ(words.exit_code, 0);
    EXPECT_EQ(words.err, "");
    EXPECT_NE(words.out.find(std::to_string(triangles) + " triangles"), std::string::npos) << words.out;
  }
}

TEST_F(LambentProgram, WritesAReferenceForAScreenToo) {
  const Outcome outcome = lambent({"reference", kHello, "-o", path("a.exr"), "--png", path("a.png"), "--size",
                                   "16x16", "--spp", "4", "--light", "constant:1,1,1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(bytesOf(folder / "a.png").starts_with("\x89PNG"));
  const Outcome nowhere = lambent({"reference", kHello, "-o", path("b.exr"), "--png", path("no/such/a.png")});
  EXPECT_EQ(nowhere.exit_code, 1);
  expectOneLine(nowhere, "lambent", "--png");
}

TEST_F(LambentProgram, ComparesPictures) {
  const std::string picture = LAMBENT_SOURCE_DIR "/tests/golden/hello_sky.exr";
  const Outcome same = lambent({"compare", picture, picture, "--reference2", picture, "--json"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(json::parse(same.out)["relativeRms"], 0.0);
  EXPECT_GT(json::parse(same.out)["pixels"], 1000);
  EXPECT_FALSE(json::parse(same.out).contains("sameSurface")) << "a picture without depths";
  EXPECT_EQ(fileCount(), 0);
  const Outcome heat =
      lambent({"compare", picture, picture, "--heat", path("heat.png"), "--heat-map", "magnitude"});
  EXPECT_EQ(heat.exit_code, 0) << heat.err;
  EXPECT_NE(heat.out.find("heat.png"), std::string::npos) << heat.out;
  EXPECT_TRUE(bytesOf(folder / "heat.png").starts_with("\x89PNG"));
  for (const auto& wrong : {std::pair("--heat-map", "rainbow"), std::pair("--heat-range", "0")})
    EXPECT_EQ(lambent({"compare", picture, picture, wrong.first, wrong.second}).exit_code, 2) << wrong.first;
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
                                   {"hello.glb", {"info", kHello}}};
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
  const auto begin = std::chrono::steady_clock::now();
  for (const std::string& output : {path("no/such/out.lmb.glb"), folder.string()})
    EXPECT_EQ(lambent({"bake", kGallery, "-o", output, "--quality", "high", "--rays", "1048576"}).exit_code,
              1);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(LambentProgram, AnInterruptEndsALongBakeAndKeepsTheOldBundle) {
  const auto bundle = folder / "gallery.lmb.glb";
  writeBytes(bundle, "the old one");
  for (const int signal : {SIGINT, SIGTERM}) {
    const ::pid_t id = start(
        LAMBENT_PROGRAM, {"bake", kGallery, "-o", bundle.string(), "--quality", "high", "--rays", "1048576"});
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    ::kill(id, signal);
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = finish(id);
    // The bake itself would take hours; a slow, sanitized build has half a minute to notice.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    EXPECT_EQ(outcome.exit_code, 1);
    expectOneLine(outcome, "lambent", "interrupted");
    EXPECT_NE(outcome.err.find("stopped; nothing was written; with a cache, the next bake would go on"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(bytesOf(bundle), "the old one");
    EXPECT_EQ(fileCount(), 1);
  }
}

TEST_F(LambentProgram, TellsALogFileEveryTenSecondsHowFarItIs) {
  const ::pid_t id = start(LAMBENT_PROGRAM, {"bake", kGallery, "-o", path("gallery.lmb.glb"), "--quality",
                                             "high", "--rays", "1048576"});
  std::this_thread::sleep_for(std::chrono::milliseconds(11500));
  ::kill(id, SIGINT);
  const Outcome outcome = finish(id);
  EXPECT_NE(outcome.err.find(" %  "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("/s, about "), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\r'), 0)
      << "a log file has no line to go back in";
}

class DamagedBundle : public LambentProgram {
 protected:
  void SetUp() override {
    LambentProgram::SetUp();
    ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
    whole = bytesOf(folder / "hello.lmb.glb");
  }
  // These bundles no program may accept; each has a reason.
  std::vector<std::pair<std::string, std::string>> damaged() const {
    std::vector<std::pair<std::string, std::string>> bundles;
    const std::size_t size = whole.size();
    for (const std::size_t length : {std::size_t{0}, std::size_t{3}, std::size_t{12}, std::size_t{21},
                                     size / 4, size / 2, size - 8, size - 1})
      bundles.emplace_back(fmt::format("cut at {}", length), whole.substr(0, length));
    for (const std::size_t at :
         {std::size_t{1}, std::size_t{9}, std::size_t{300}, size / 3, size / 2, size - 20}) {
      bundles.emplace_back(fmt::format("flipped at {}", at), whole);
      bundles.back().second[at] ^= 0x10;
    }
    bundles.emplace_back("trailing bytes", whole + "0123");
    return bundles;
  }
  // Writes the same bundle as a future version of the program would.
  std::string tooNew() const {
    const std::string field = "\"LAMBENT_radiance_transfer\":{";
    const std::size_t extension = whole.find(field);
    const std::size_t version =
        whole.find("\"version\":" + std::to_string(bundle::kVersionCurrent), extension);
    EXPECT_NE(version, std::string::npos);
    std::string bundle = whole;
    bundle[version + 10] = '9';
    return bundle;
  }

  std::string whole;
};

TEST_F(DamagedBundle, IsToldByInfoInOneLine) {
  for (const auto& [what, bytes] : damaged()) {
    writeBytes(folder / "damaged.lmb.glb", bytes);
    const Outcome outcome = lambent({"info", path("damaged.lmb.glb")});
    EXPECT_EQ(outcome.exit_code, 1) << what;
    expectOneLine(outcome, "lambent", what);
    EXPECT_NE(outcome.err.find("damaged.lmb.glb: "), std::string::npos) << what << "\n" << outcome.err;
  }
  writeBytes(folder / "future.lmb.glb", tooNew());
  const Outcome outcome = lambent({"info", path("future.lmb.glb")});
  EXPECT_EQ(outcome.exit_code, 1);
  expectOneLine(outcome, "lambent", "too new");
  EXPECT_NE(outcome.err.find("newer"), std::string::npos) << outcome.err;
}

TEST_F(DamagedBundle, IsToldByTheDemoInOneLineAndGivesNoPicture) {
  const auto show = [&](const std::string& name) {
    return run(LAMBENT_DEMO,
               {path(name), "--light", "constant:1,1,1", "--size", "32x32", "--headless", path("a.png")});
  };
  const Outcome intact = show("hello.lmb.glb");
  if (testing::lacksDevice(intact)) LAMBENT_LACKS("gl", intact.err);
  ASSERT_EQ(intact.exit_code, 0) << intact.err;
  ASSERT_TRUE(std::filesystem::remove(folder / "a.png"));
  auto bundles = damaged();
  bundles.emplace_back("too new", tooNew());
  for (const auto& [what, bytes] : bundles) {
    writeBytes(folder / "damaged.lmb.glb", bytes);
    const Outcome outcome = show("damaged.lmb.glb");
    EXPECT_EQ(outcome.exit_code, 1) << what;
    expectOneLine(outcome, "lambent-demo", what);
    EXPECT_NE(outcome.err.find("damaged.lmb.glb: "), std::string::npos) << what << "\n" << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.png")) << what;
  }
}

TEST_F(LambentProgram, BundlesPassTheKhronosValidator) {
  ASSERT_EQ(bakeHello("hello.lmb.glb").exit_code, 0);
  const Outcome gallery = lambent({"bake", kGallery, "-o", path("gallery.lmb.glb"), "--quality", "draft"});
  ASSERT_EQ(gallery.exit_code, 0) << gallery.err;
  const Outcome outcome = run(LAMBENT_SOURCE_DIR "/tests/support/validate_gltf.sh",
                              {path("hello.lmb.glb"), path("gallery.lmb.glb")});
  if (outcome.exit_code == 77) LAMBENT_LACKS("validator", outcome.out);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

TEST_F(LambentProgram, SaysThatABakeCannotBeResumedAndBakesOn) {
  std::filesystem::create_directories(folder / "cache");
  writeBytes(folder / "cache/journal", "a file where the journal's folder has to be");
  const Outcome baked = bakeHello("hello.lmb.glb", {"--cache", path("cache")});
  EXPECT_EQ(baked.exit_code, 0) << baked.err;
  EXPECT_NE(baked.err.find("journal"), std::string::npos) << baked.err;
  EXPECT_NE(baked.err.find("--resume will not know of this bake"), std::string::npos) << baked.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "hello.lmb.glb"));
}

// Kills the bake as soon as this many results are in the cache, whatever it does at that moment.
TEST_F(LambentProgram, GoesOnWhereItWasKilled) {
  const std::string cache = path("cache");
  const std::vector<std::string> options = {"--rays", "4096", "--cache", cache};
  ASSERT_EQ(bakeHello("whole.lmb.glb", {"--rays", "4096"}).exit_code, 0);
  const auto entries = [&] {
    std::ptrdiff_t count = 0;
    std::error_code ignored;
    for (std::filesystem::recursive_directory_iterator at(cache, ignored), end; !ignored && at != end;
         at.increment(ignored))
      count += at->path().extension() == ".entry";
    return count;
  };
  for (const std::ptrdiff_t enough : {1, 6}) {
    std::vector<std::string> arguments = {"bake",      kHello,  "-o",        path("killed.lmb.glb"),
                                          "--quality", "draft", "--threads", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ::pid_t id = start(LAMBENT_PROGRAM, arguments);
    int status = 0;
    while (entries() < enough && ::waitpid(id, &status, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(id, SIGKILL);
    ::waitpid(id, &status, 0);
    EXPECT_FALSE(std::filesystem::exists(path("killed.lmb.glb")));
  }
  std::vector<std::string> rest = options;
  rest.push_back("--json");
  const Outcome resumed = bakeHello("resumed.lmb.glb", rest);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  const json report = json::parse(resumed.out);
  EXPECT_GT(report["refinement"]["raysKept"].get<double>(), 0.0);
  EXPECT_TRUE(bytesOf(path("resumed.lmb.glb")) == bytesOf(path("whole.lmb.glb")));
}

}  // namespace lambent
