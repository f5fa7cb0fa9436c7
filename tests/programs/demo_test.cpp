// Tests lambent-demo as a user sees it: exit codes, one-line errors, pictures, the report.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/image.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

class DemoProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    folder =
        std::filesystem::path(::testing::TempDir()) /
        fmt::format("{}-demo-{}", getpid(), ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  // `before` stands before it in the shell.
  Outcome run(const std::string& arguments, const std::string& before = {}) const {
    const std::filesystem::path err = folder / "stderr.txt";
    const std::string command =
        fmt::format("{}{} {} 2>{}", before, quoted(LAMBENT_DEMO), arguments, quoted(err));
    Outcome outcome;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> buffer{};
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
      outcome.out.append(buffer.data(), count);
    const int status = pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    outcome.err = readTextFile(err).value_or("");
    return outcome;
  }

  std::string bundle() const {
    const std::filesystem::path path = folder / "sphere.lmb.glb";
    testing::BundleBuilder().add({testing::sphereMesh(12, 24), {}}).write(path);
    return quoted(path);
  }

  // Quotes it as one word of a shell command.
  static std::string quoted(const std::filesystem::path& path) { return fmt::format("'{}'", path.string()); }

  std::filesystem::path folder;
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

TEST_F(DemoProgram, SaysThatADeviceIsTooOldInOneLine) {
  LAMBENT_NEEDS_DEVICE();
  if (gpu::Context::createHeadless()->info().version.find("Mesa") == std::string::npos)
    GTEST_SKIP() << "only Mesa's drivers can be told to offer less";
  const std::filesystem::path picture = folder / "a.png";
  ::setenv("MESA_GL_VERSION_OVERRIDE", "4.3", /*overwrite=*/1);
  const Outcome outcome = run(bundle() + " --light constant:1,1,1 --headless " + quoted(picture));
  ::unsetenv("MESA_GL_VERSION_OVERRIDE");
  EXPECT_EQ(outcome.exit_code, 1);
  expectOneLine(outcome.err);
  EXPECT_NE(outcome.err.find("OpenGL: no device gives OpenGL 4.5 core"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(picture));
}

TEST_F(DemoProgram, LeavesNoHalfPictureWhereTheDiskIsFull) {
  LAMBENT_NEEDS_DEVICE();
  const std::filesystem::path picture = folder / "a.exr";
  const Outcome outcome =
      run(bundle() + " --light sun:35,45,6,5 --size 128x128 --headless " + quoted(picture), "ulimit -f 8; ");
  EXPECT_EQ(outcome.exit_code, 1);
  expectOneLine(outcome.err);
  EXPECT_NE(outcome.err.find("a.exr: cannot be written: File too large"), std::string::npos) << outcome.err;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_EQ(entry.path().filename().string().find("a.exr"), std::string::npos) << entry.path();
}

TEST_F(DemoProgram, WrongUsageIsExitCode2AndOneLine) {
  for (const char* arguments : {"",
                                "a.glb --size 0x5",
                                "a.glb --light moon:1",
                                "a.glb --camera orbit:1",
                                "a.glb --transfer some",
                                "a.glb --window foggy",
                                "a.glb --view transfer",
                                "a.glb --view clusters:1",
                                "a.glb --overlay lights,fog",
                                "a.glb --overlay neighborhoods:w,0.5",
                                "a.glb --headless a.jpg",
                                "a.glb --exposure bright",
                                "a.glb --frames 0",
                                "a.glb --rotate-light much",
                                "a.glb --light-layout round",
                                "a.glb --lamps -1",
                                "a.glb --lamps bright",
                                "a.glb --max-memory much",
                                "a.glb --time nan",
                                "a.glb --step -1",
                                "a.glb --fade 0.5",
                                "a.glb --edit-key key:1,2,3",
                                "a.glb --quality best",
                                "a.glb --fade 2 --fade-to constant:1,1,1",
                                "a.glb --fade-to sphere:0,1,0,1,1",
                                "a.glb --capture-size 3",
                                "a.glb --capture-subsamples 17",
                                "a.glb --capture-order 9",
                                "a.glb --order 0",
                                "a.glb --glossy some",
                                "a.glb --light sphere:0,1,0,-1,1",
                                "a.glb --no-such-option"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    expectOneLine(outcome.err);
    EXPECT_EQ(outcome.out, "") << arguments;
  }
}

TEST_F(DemoProgram, HelpAndVersionAreExitCode0) {
  EXPECT_EQ(run("--version").exit_code, 0);
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option :
       {"--light",         "--light-layout", "--camera", "--size",         "--headless",
        "--transfer",      "--window",       "--view",   "--overlay",      "--frames",
        "--rotate-light",  "--exposure",     "--lamps",  "--max-memory",   "--fade-to",
        "--fade",          "--time",         "--step",   "--capture-size", "--capture-subsamples",
        "--capture-order", "--json",         "--version"})
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
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

TEST_F(DemoProgram, KeepsToItsMemoryAndDimsLamps) {
  LAMBENT_NEEDS_DEVICE();
  const std::filesystem::path lit = folder / "lit.lmb.glb", exr = folder / "a.exr";
  testing::BundleBuilder()
      .lamp({.kind = bundle::GroupLight::Kind::Node, .index = 0, .color = glm::vec3(2.0f)}, 0.5f)
      .add({testing::sphereMesh(12, 24), {}})
      .write(lit);
  // The column is of no light that stands anywhere, so all of it has to be used.
  const auto centre = [&](const std::string& more) {
    const Outcome outcome =
        run(quoted(lit) + " --light constant:0,0,0 --size 64x64 --local-shadows off --json " + "--headless " +
            quoted(exr) + more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto picture = spec::readExr(exr);
    EXPECT_TRUE(picture);
    return std::pair{nlohmann::json::parse(outcome.out), picture->texels[32 * 64 + 32].r};
  };
  const auto [whole, bright] = centre("");
  EXPECT_EQ(whole["planes_resident"], whole["planes_in_bundles"]);
  EXPECT_NEAR(bright, 1.0f, 1e-3f);
  EXPECT_NEAR(centre(" --lamps 0.25").second, 0.25f, 1e-3f);
  const auto [cut, still_bright] = centre(" --max-memory 1kB");
  EXPECT_EQ(cut["planes_resident"], 0);
  EXPECT_EQ(cut["streaming"]["shown_partly"], 1);
  EXPECT_EQ(whole["streaming"]["shown_in_full"], 1);
  EXPECT_LT(cut["bytes_loaded"], whole["bytes_loaded"]);
  EXPECT_LE(whole["bytes_loaded"], whole["bytes_in_bundles"]);
  EXPECT_LT(cut["bytes_resident"], whole["bytes_resident"]);
}

TEST_F(DemoProgram, FadesFromOneLightToAnother) {
  LAMBENT_NEEDS_DEVICE();
  const std::filesystem::path exr = folder / "a.exr";
  const Outcome outcome =
      run(bundle() + " --light constant:1,0,0 --fade-to constant:0,2,0 --fade 0.25 --size 64x64" +
          " --headless " + quoted(exr));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto picture = spec::readExr(exr);
  ASSERT_TRUE(picture);
  const glm::vec4 centre = picture->texels[32 * 64 + 32];
  EXPECT_NEAR(centre.r, 0.75f, 3e-3f);
  EXPECT_NEAR(centre.g, 0.5f, 3e-3f);
}

TEST_F(DemoProgram, MovesAndDimsAKeyLightOfAProbe) {
  LAMBENT_NEEDS_DEVICE();
  // The sky is grey, with one bright texel at azimuth -40, elevation 40.
  spec::RgbImage sky{.width = 128, .height = 64, .texels = std::vector<glm::vec3>(128 * 64, glm::vec3(0.5f))};
  sky.texels[18 * 128 + 50] = glm::vec3(9000.0f);
  ASSERT_TRUE(spec::writeHdr(folder / "sky.hdr", sky));
  const auto keyOf = [&](const std::string& options) {
    const Outcome outcome = run(bundle() + " --light " + quoted(folder / "sky.hdr") + options +
                                " --size 32x32 --json --headless " + quoted(folder / "a.png"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(report["key_lights"].size(), 1u);
    return report["key_lights"][0];
  };
  const auto found = keyOf("");
  const auto edited = keyOf(" --edit-key key:" + found["azimuth_deg"].dump() + "," +
                            found["elevation_deg"].dump() + ",10,20,0.5,0.25,1");
  EXPECT_NEAR(edited["azimuth_deg"].get<double>(), 10.0, 1e-3);
  EXPECT_NEAR(edited["elevation_deg"].get<double>(), 20.0, 1e-3);
  EXPECT_EQ(edited["radius_deg"], found["radius_deg"]);
  for (std::size_t channel = 0; const double factor : {0.5, 0.25, 1.0}) {
    const double was = found["radiance"][channel];
    EXPECT_NEAR(edited["radiance"][channel++].get<double>(), factor * was, 1e-3 * was);
  }
  // An edit of no existing key light is reported, and changes nothing.
  const Outcome told =
      run(bundle() + " --light constant:1,1,1 --edit-key key:0,0,0,0,1 --size 32x32 --headless " +
          quoted(folder / "a.png"));
  EXPECT_EQ(told.exit_code, 0);
  expectOneLine(told.err);
}

TEST_F(DemoProgram, ALightInTheSceneShinesByTheSquareOfItsDistance) {
  LAMBENT_NEEDS_DEVICE();
  const std::filesystem::path exr = folder / "a.exr";
  const auto centre = [&](const std::string& light) {
    const Outcome outcome =
        run(bundle() + " --light " + light + " --local-radii 0 --window off --size 64x64 --json --headless " +
            quoted(exr));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(report["last_frame"]["counts"]["local_lights"], 1);
    EXPECT_EQ(report["last_frame"]["counts"]["shadowed_lights"], 0) << "outside the sphere's bounds";
    const auto picture = spec::readExr(exr);
    EXPECT_TRUE(picture);
    return picture->texels[32 * 64 + 32].r;
  };
  // Towards the camera, which stands on +Z; sampled at the sphere's centre.
  const float near = centre("sphere:0,0,20,1,100"), far = centre("sphere:0,0,40,1,100");
  EXPECT_NEAR(near / far, 4.0f, 0.02f);
  EXPECT_EQ(centre("sphere:0,0,20,0,100"), 0.0f) << "a light of no size";
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
