// Tests the help of the programs, and the completion of their words that is made of it.
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/program.hpp"

namespace lambent {
namespace {

using testing::Outcome;

struct Page {
  std::string program;
  std::vector<std::string> command;  // "bake", or nothing for the program's own page
};

std::set<std::string> optionsOf(const std::string& text) {
  static const std::regex kOption(R"((?:^|[ ,/])(--[a-z][a-z0-9-]+))");
  std::set<std::string> options;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (std::smatch found; line.starts_with("  -") && std::regex_search(line, found, kOption))
      options.insert(found[1]);
  return options;
}

class Help : public testing::ProgramTest {
 protected:
  Outcome ask(const Page& page, const std::vector<std::string>& words) const {
    std::vector<std::string> all = page.command;
    all.insert(all.end(), words.begin(), words.end());
    return run(page.program, all);
  }
  std::vector<Page> pages() const {
    std::vector<Page> pages = {{LAMBENT_PROGRAM, {}}, {LAMBENT_DEMO, {}}, {LAMBENT_EDITOR, {}}};
    for (const char* command : {"bake", "plan", "info", "view", "reference", "compare", "accuracy", "export"})
      pages.push_back({LAMBENT_PROGRAM, {command}});
    return pages;
  }
};

}  // namespace

TEST_F(Help, OfEveryCommandEndsWithExamplesAndExitCodesAndFits) {
  for (const Page& page : pages()) {
    const Outcome version = ask(page, {"--version"}), asked = ask(page, {"--help"});
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_TRUE(version.out.starts_with("lambent")) << version.out;
    EXPECT_EQ(asked.exit_code, 0);
    EXPECT_EQ(asked.err, "");
    const std::string& help = asked.out;
    const std::size_t examples = help.find("\nExamples:\n  lambent"), codes = help.find("\nExit codes:\n");
    EXPECT_NE(examples, std::string::npos) << help;
    EXPECT_NE(codes, std::string::npos) << help;
    EXPECT_LT(examples, codes) << help;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);)
      if (line.find("Usage: ") != 0) {
        EXPECT_LE(line.size(), 102u) << line;  // bytes; a few letters have two
      }
  }
}

// Options that nobody put in a group stand with --help under "Options".
TEST_F(Help, PutsTheOptionsOfLargeCommandsInGroups) {
  for (const Page& page : {Page{LAMBENT_PROGRAM, {"bake"}}, Page{LAMBENT_PROGRAM, {"reference"}},
                           Page{LAMBENT_DEMO, {}}, Page{LAMBENT_EDITOR, {}}}) {
    const std::string help = ask(page, {"--help"}).out;
    const std::size_t at = help.find("\nOptions:\n");
    ASSERT_NE(at, std::string::npos) << help;
    EXPECT_EQ(optionsOf(help.substr(at, help.find("\n\n", at + 1) - at)),
              (std::set<std::string>{"--help", "--version"}));
  }
}

// Asks bash itself what it would offer after these words.
TEST_F(Help, CompletesWordsInBash) {
  if (!std::filesystem::exists("/bin/bash")) GTEST_SKIP() << "there is no bash";
  const auto offered = [&](const char* program, const std::vector<std::string>& words) {
    std::string script =
        fmt::format(". '{}/cmake/package/completion.bash'; COMP_WORDS=('{}' ", LAMBENT_SOURCE_DIR, program);
    for (const std::string& word : words) script += "'" + word + "' ";
    script += fmt::format("); COMP_CWORD={}; _lambent '{}'; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
                          words.size(), program);
    const Outcome outcome = run("/bin/bash", {"-c", script});
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  };
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"ba"}), "bake\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"bake", "--qua"}), "--quality\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"bake", "--quality", "d"}), "draft\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"info", "--js"}), "--json\n");
  EXPECT_EQ(offered(LAMBENT_DEMO, {"--headl"}), "--headless\n");
  EXPECT_EQ(offered(LAMBENT_DEMO, {"--quality", "h"}), "high\n");
}

}  // namespace lambent
