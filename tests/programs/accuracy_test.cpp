// Tests `lambent accuracy` as a user sees it, over a scene that bakes in a moment.
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

namespace lambent {
namespace {

using nlohmann::json;
using testing::expectOneLine;
using testing::Outcome;

const std::string kHello = LAMBENT_BINARY_DIR "/assets/hello.glb";

class Accuracy : public testing::ProgramTest {
 protected:
  std::string out() const { return (folder / "out").string(); }
  Outcome measure(std::vector<std::string> options = {}) const {
    const std::vector<std::string> words = {"accuracy", kHello,   "-o",      out(),    "--size",
                                            "64x36",    "--spp",  "8",       "--json", "--knob",
                                            "rays=128", "--knob", "keys=off"};
    options.insert(options.begin(), words.begin(), words.end());
    return run(LAMBENT_PROGRAM, options);
  }
};

TEST_F(Accuracy, MeasuresWritesAPageAndMeasuresNothingAgain) {
  const Outcome first = measure();
  if (first.err.find("OpenGL: ") != std::string::npos)
    LAMBENT_LACKS("gl", "there is no OpenGL 4.5 here: " << first.err);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const json report = json::parse(first.out);
  // Two bakes, three pictures, and references of light as it is and of five bands with two seeds each.
  EXPECT_EQ(report.at("rowsMeasured"), 9);
  ASSERT_EQ(report.at("rows").size(), 3u);
  for (const json& row : report.at("rows")) {
    EXPECT_GT(row.at("bake").at("seconds"), 0.0);
    EXPECT_GT(row.at("picture").at("frameMs"), 0.0);
    const double error = row.at("picture").at("asLightIs").at("rms");
    EXPECT_GE(error, 0.0);
    EXPECT_LT(error, 1.0);
  }
  EXPECT_EQ(json::parse(std::ifstream(folder / "out" / "sweep.json")), report);
  EXPECT_GT(std::filesystem::file_size(folder / "out" / "index.html"), 20000u);

  const Outcome second = measure();
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(json::parse(second.out).at("rowsMeasured"), 0);
  EXPECT_EQ(json::parse(second.out).at("rows"), report.at("rows"));
}

TEST_F(Accuracy, WrongUsageIsExitCode2AndOneLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {"accuracy"},
      {"accuracy", kHello},
      {"accuracy", kHello, "-o", out(), "--quality", "splendid"},
      {"accuracy", kHello, "-o", out(), "--knob", "volume"},
      {"accuracy", kHello, "-o", out(), "--knob", "rays=few"},
      {"accuracy", kHello, "-o", out(), "--size", "small"},
      {"accuracy", kHello, "-o", out(), "--spp", "0"},
      {"accuracy", kHello, "-o", out(), "--light", "sun:1"}};
  for (const auto& words : wrong) {
    const Outcome outcome = run(LAMBENT_PROGRAM, words);
    EXPECT_EQ(outcome.exit_code, 2) << words.back();
    expectOneLine(outcome, "lambent", words.back());
  }
  EXPECT_FALSE(std::filesystem::exists(out()));
}

}  // namespace
}  // namespace lambent
