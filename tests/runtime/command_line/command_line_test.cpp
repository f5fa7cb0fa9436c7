// Tests what --help says of options.
#include <algorithm>
#include <sstream>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "runtime/command_line/help.hpp"

namespace lambent::command_line {
namespace {

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    CLI::App* bake = app_.add_subcommand("bake", "Bake a scene");
    bake->add_option("SCENE", scene_, "The scene; .gltf")->required();
    bake->add_option("--quality", word_, "How fine it is, which\nsays it all. Really")
        ->type_name("draft|high|N")
        ->default_str("draft");
    bake->add_option("-s,--seconds", seconds_, "Don't take [longer]")
        ->check(CLI::Range(0.5, 60.0))
        ->type_name("S");
    bake->add_option("--former", word_, "Hidden")->group("");
    bake->add_flag("--force", force_, "Begin anew");
    group(*bake, "Accuracy", {"--quality"});
    addExamples(*bake, {{"tool bake a.gltf", "bakes it"}}, "A note that ends the page.");
    std::string words;
    for (int i = 0; i < 60; ++i) words += "words ";
    app_.add_subcommand("long", "Long")->add_flag("--long", force_, words);
    app_.add_subcommand("info", "Say what is in a bundle");
    addExamples(app_, {});
    finish(app_, "tool 1.2");
  }

  // Returns what the program prints for these words, and its exit code.
  std::pair<std::string, int> printed(std::vector<std::string> words) {
    std::ranges::reverse(words);  // as the library wants them
    try {
      app_.parse(words);
    } catch (const CLI::ParseError& end) {
      std::ostringstream out, err;
      const int code = app_.exit(end, out, err);
      return {out.str() + err.str(), code};
    }
    return {"", 0};
  }

  CLI::App app_{"Makes tests.", "tool"};
  std::string scene_, word_;
  double seconds_ = 0.0;
  bool force_ = false;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_F(CommandLine, HelpHasGroupsThenExamplesThenExitCodes) {
  const auto [help, code] = printed({"bake", "--help"});
  EXPECT_EQ(code, 0);
  const std::size_t options = help.find("\nOptions:\n"), accuracy = help.find("\nAccuracy:\n  --quality"),
                    note = help.find("\nA note that ends the page.\n"),
                    examples = help.find("\nExamples:\n  tool bake a.gltf\n      bakes it\n"),
                    codes = help.find("\nExit codes:\n  0  done\n  1  failed\n  2  wrong usage\n");
  for (const std::size_t at : {options, accuracy, note, examples, codes})
    EXPECT_NE(at, std::string::npos) << help;
  EXPECT_TRUE(options < accuracy && accuracy < note && note < examples && examples < codes) << help;
  EXPECT_TRUE(has(help, "--quality draft|high|N=draft")) << help;
  EXPECT_TRUE(has(help, "How fine it is, which says it all.")) << "breaks of the source are none of the help";
  EXPECT_TRUE(has(help, "-s,--seconds S")) << help;
  EXPECT_TRUE(has(help, "Don't take [longer]; 0.5..60")) << help;
  EXPECT_FALSE(has(help, "--former")) << help;
}

TEST_F(CommandLine, WrappedCountsLettersAndNotBytes) {
  EXPECT_EQ(wrapped("order² is\nmore", 9), "order² is\nmore");
  EXPECT_EQ(wrapped("  a   b ", 80), "a b");
  EXPECT_EQ(wrapped("unbreakable word", 3), "unbreakable\nword");
}

}  // namespace lambent::command_line
