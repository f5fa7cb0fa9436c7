// Tests lambent-demo as a user sees it: exit codes, one-line errors, pictures, the report.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/spec/image.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"
#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using testing::Outcome;

class DemoProgram : public testing::ProgramTest {
 protected:
  // Runs the program with words as a shell splits them.
  Outcome run(const std::string& arguments) const {
    return ProgramTest::run("/bin/sh", {"-c", fmt::format("{} {}", quoted(LAMBENT_DEMO), arguments)});
  }

  std::string bundle() const {
    const std::filesystem::path path = folder / "sphere.lmb.glb";
    testing::BundleBuilder().add({testing::sphereMesh(12, 24), {}}).write(path);
    return quoted(path);
  }

  // Quotes it as one word of a shell command.
  static std::string quoted(const std::filesystem::path& path) { return fmt::format("'{}'", path.string()); }
};

// Ends the calling TEST if there is no device that draws.
#define LAMBENT_NEEDS_DEVICE()                                                 \
  if (const Result<gpu::Context> made = gpu::Context::createHeadless(); !made) \
  LAMBENT_LACKS("gl", "no OpenGL 4.5 here: " << made.error().line())

void expectOneLine(const std::string& text) {
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_TRUE(text.starts_with("lambent-demo: ")) << text;
}

}  // namespace

TEST_F(DemoProgram, WrongUsageIsExitCode2AndOneLine) {
  for (const char* arguments : {"",
                                "a.glb --size 0x5",
                                "a.glb --transfer some",
                                "a.glb --view transfer",
                                "a.glb --overlay lights,fog",
                                "a.glb --headless a.jpg",
                                "a.glb --exposure bright",
                                "a.glb --frames 0",
                                "a.glb --rotate-light much",
                                "a.glb --lamps -1",
                                "a.glb --max-memory much",
                                "a.glb --time nan",
                                "a.glb --step -1",
                                "a.glb --fade 0.5",
                                "a.glb --quality best",
                                "a.glb --fade 2 --fade-to constant:1,1,1",
                                "a.glb --capture-size 3",
                                "a.glb --order 0",
                                "a.glb --glossy some",
                                "a.glb --no-such-option"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    expectOneLine(outcome.err);
    EXPECT_EQ(outcome.out, "") << arguments;
  }
}

TEST_F(DemoProgram, AMissingFileIsExitCode1AndNamed) {
  const Outcome environment_map =
      run(quoted(LAMBENT_BINARY_DIR "/assets/hello.glb") + " --light nowhere.hdr --headless a.png");
  EXPECT_EQ(environment_map.exit_code, 1);
  expectOneLine(environment_map.err);
  EXPECT_NE(environment_map.err.find("nowhere.hdr"), std::string::npos);
  // It is said before anything else, such as which light will shine on it.
  const Outcome scene = run(quoted(folder / "lost.lmb.glb") + " --headless a.png");
  EXPECT_EQ(scene.exit_code, 1);
  expectOneLine(scene.err);
  EXPECT_NE(scene.err.find("lost.lmb.glb"), std::string::npos);
}

TEST_F(DemoProgram, WritesPicturesAndPrintsWhere) {
  LAMBENT_NEEDS_DEVICE();
  const std::string png = (folder / "a.png").string(), exr = (folder / "a.exr").string();
  const Outcome display = run(bundle() + " --light constant:1,1,1 --size 96x64 --headless " + quoted(png));
  ASSERT_EQ(display.exit_code, 0) << display.err;
  EXPECT_EQ(display.out, png + "\n");
  EXPECT_EQ(display.err, "");
  const auto image = spec::readPng(png);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 96u);
  ASSERT_EQ(run(bundle() + " --light constant:1,2,3 --size 64x64 --headless " + quoted(exr)).exit_code, 0);
  const auto linear = spec::readExr(exr);
  ASSERT_TRUE(linear);
  const glm::vec4 centre = linear->texels[32 * 64 + 32];
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(centre[i], static_cast<float>(i + 1), 3e-3f);  // half-float basis
  EXPECT_EQ(centre.a, 1.0f);
}

TEST_F(DemoProgram, ANumberedNameGetsEveryFrameEachAsThePictureByItself) {
  LAMBENT_NEEDS_DEVICE();
  const std::string light = bundle() + " --light sun:0,30,20,5 --size 64x64 --rotate-light ";
  const Outcome all = run(light + "90 --frames 2 --headless " + quoted(folder / "f-##.exr"));
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_EQ(all.out, (folder / "f-00.exr").string() + "\n" + (folder / "f-01.exr").string() + "\n");
  const char* const turns[] = {"45", "90"};
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(run(light + turns[i] + " --headless " + quoted(folder / "one.exr")).exit_code, 0);
    const auto one = spec::readExr(folder / "one.exr");
    const auto frame = spec::readExr(folder / ("f-0" + std::to_string(i) + ".exr"));
    ASSERT_TRUE(one && frame);
    EXPECT_EQ(one->texels, frame->texels) << i;
  }
}

TEST_F(DemoProgram, ReportsAsJson) {
  LAMBENT_NEEDS_DEVICE();
  const std::string png = (folder / "a.png").string();
  const Outcome outcome =
      run(bundle() + " --light sun:0,40,5,50 --size 64x64 --frames 3 --json --headless " + quoted(png));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["picture"], png);
  EXPECT_EQ(report["size"], nlohmann::json({64, 64}));
  EXPECT_EQ(report["gl_errors"], 0);
  EXPECT_GT(report["bytes_resident"], 0);
  EXPECT_GE(report["negative_pixels"], 0);
  EXPECT_FALSE(report["renderer"].get<std::string>().empty());
  const auto dispatches = [&](const char* frame) {
    for (const auto& pass : report[frame]["passes"])
      if (pass["name"] == "shade") return pass["dispatches"].get<int>();
    return -1;
  };
  EXPECT_EQ(dispatches("first_frame"), 3);
  EXPECT_EQ(dispatches("last_frame"), 0) << "a still frame shades nothing";
  for (const auto& pass : report["last_frame"]["passes"]) EXPECT_TRUE(pass["gpu_ms"].is_number()) << pass;
  for (const auto& pass : report["last_frame"]["passes"]) EXPECT_EQ(pass["reason"], "") << "a still frame";
  EXPECT_EQ(report["first_frame"]["passes"][2]["name"], "light");
  EXPECT_EQ(report["first_frame"]["passes"][2]["reason"], "first frame");
  EXPECT_EQ(report["settings"]["window"], "off");
  EXPECT_EQ(report["settings"]["keys"], "auto");
  EXPECT_EQ(report["key_lights"].size(), report["last_frame"]["counts"]["key_lights"]);
  EXPECT_EQ(report["first_frame"]["counts"]["light_probes_written"], 1);
  EXPECT_EQ(report["last_frame"]["counts"]["light_probes_written"], 0);
  EXPECT_EQ(report["last_frame"]["counts"]["cells_shaded"], 0);
  EXPECT_EQ(report["last_frame"]["counts"]["light_probes_captured"], 0) << "one body sees no other";
  EXPECT_GT(report["frame_ms"]["median"], 0.0);
}

TEST_F(DemoProgram, LeavesNoPictureWhereItCannotWrite) {
  LAMBENT_NEEDS_DEVICE();
  const Outcome outcome =
      run(bundle() + " --light constant:1,1,1 --size 16x16 --headless " + quoted(folder / "no/such/a.png"));
  EXPECT_EQ(outcome.exit_code, 1);
  expectOneLine(outcome.err);
}

}  // namespace lambent
