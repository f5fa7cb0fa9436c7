// Tests `lambent bake` as a user sees it: when it bakes, what it reports, and how it ends and goes on.

#include <nlohmann/json.hpp>

#include "tests/programs/lambent_program.hpp"
#include "tests/support/require.hpp"

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

TEST_F(LambentProgram, FailsStrictlyWhereABoundIsMissedAndWritesTheBundle) {
  const std::vector<std::string> coarse = {"--refine", "off", "--rays", "128", "--error", "0.05%"};
  const Outcome lenient = bakeHello("hello.lmb.glb", coarse);
  EXPECT_EQ(lenient.exit_code, 0) << lenient.err;
  EXPECT_NE(lenient.out.find("\n  missed    pictures of \"static\" are "), std::string::npos) << lenient.out;
  std::vector<std::string> strictly = coarse;
  strictly.push_back("--strict");
  EXPECT_EQ(bakeHello("strict.lmb.glb", strictly).exit_code, 1);
  EXPECT_TRUE(bytesOf(folder / "strict.lmb.glb") == bytesOf(folder / "hello.lmb.glb"));
  EXPECT_EQ(bakeHello("fine.lmb.glb", {"--strict"}).exit_code, 0);
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
  const std::vector<std::pair<const char*, bool>> effects = {
      {"diffuse", true}, {"glossy", false}, {"volume", false}, {"neighborhood", false}};
  ASSERT_EQ(plan["effects"].size(), effects.size());
  for (std::size_t i = 0; i < effects.size(); ++i) {
    EXPECT_EQ(plan["effects"][i]["effect"], effects[i].first);
    EXPECT_EQ(plan["effects"][i]["baked"], effects[i].second) << effects[i].first;
  }
  EXPECT_FALSE(plan["effects"][0]["reason"].get<std::string>().empty());
  for (const char* figure : {"samples", "rays", "seconds", "processorSeconds", "memoryBytes"})
    EXPECT_GT(plan["estimate"][figure], 0.0) << figure;
  ASSERT_EQ(plan["groups"][0]["primitives"].size(), 3u) << "floor, box and sphere";
  const auto expectDecided = [](const json& decisions) {
    ASSERT_FALSE(decisions.empty());
    for (const json& decision : decisions) {
      const auto word = decision["decision"].get<std::string>();
      EXPECT_TRUE(word == "baked" || word == "leftOut" || word == "absent") << word;
      EXPECT_FALSE(decision["reason"].get<std::string>().empty()) << decision;
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
                info["lightWeightBytes"].get<int>() + info["importanceBytes"].get<int>(),
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

TEST_F(LambentProgram, AnInterruptEndsALongBakeAndKeepsTheOldBundle) {
  const auto bundle = folder / "gallery.lmb.glb";
  writeBytes(bundle, "the old one");
  for (const int signal : {SIGINT, SIGTERM}) {
    // The bake itself would take hours.
    const Outcome outcome = interrupt({"bake", kGallery, "-o", bundle.string(), "--quality", "high", "--rays",
                                       "1048576", "--quiet", "--progress", "json"},
                                      "{", signal);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("stopped; nothing was written; with a cache, the next bake would go on"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(bytesOf(bundle), "the old one");
    EXPECT_EQ(fileCount(), 1);
  }
}

TEST_F(LambentProgram, TellsALogFileThatItTakesLongAndEveryTenSecondsHowFarItIs) {
  const Outcome outcome =
      interrupt({"bake", kGallery, "-o", path("gallery.lmb.glb"), "--quality", "high", "--rays", "1048576"},
                "/s, about ", SIGINT);
  EXPECT_TRUE(outcome.err.starts_with("lambent: " + kGallery + ": takes about ")) << outcome.err;
  EXPECT_NE(outcome.err.find(" of processor time"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(" %  "), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\r'), 0)
      << "a log file has no line to go back in";
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

}  // namespace
}  // namespace lambent
