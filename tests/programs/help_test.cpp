// Tests that the help, the manual pages and the completions of the programs agree, since all come from the
// tables of options, and that the tools that read them accept them.
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"

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
    std::istringstream names(run(LAMBENT_PROGRAM, {"--help-as", "commands"}).out);
    for (std::string name; std::getline(names, name);) pages.push_back({LAMBENT_PROGRAM, {name}});
    return pages;
  }
};

}  // namespace

TEST_F(Help, OfEveryCommandEndsWithExamplesAndExitCodesAndFits) {
  ASSERT_GE(pages().size(), 10u);
  for (const Page& page : pages()) {
    const std::string help = ask(page, {"--help"}).out;
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

TEST_F(Help, StandsInTheManualPagesOptionByOption) {
  for (const Page& page : pages()) {
    const std::set<std::string> options = optionsOf(ask(page, {"--help"}).out);
    EXPECT_TRUE(options.contains("--version"));
    const Outcome manual = ask(page, {"--help-as", "man"});
    EXPECT_EQ(manual.exit_code, 0) << manual.err;
    std::string text = manual.out;
    for (std::size_t at = 0; (at = text.find("\\-", at)) != std::string::npos;) text.erase(at, 1);
    for (const std::string& option : options)
      EXPECT_NE(text.find("\\fB" + option + "\\fR"), std::string::npos) << option << "\n" << text;
  }
}

TEST_F(Help, GivesManualPagesThatManTakesWithoutAWord) {
  if (!std::filesystem::exists("/usr/bin/groff")) LAMBENT_LACKS("groff", "there is no groff");
  for (const Page& page : pages()) {
    testing::writeBytes(folder / "page.1", ask(page, {"--help-as", "man"}).out);
    const Outcome set = run("/usr/bin/groff", {"-man", "-Tutf8", "-K", "utf8", "-ww", "-rCHECKSTYLE=1", "-z",
                                               (folder / "page.1").string()});
    EXPECT_EQ(set.exit_code, 0);
    EXPECT_EQ(set.err, "") << testing::bytesOf(folder / "page.1");
  }
}

// Asks bash itself what it would offer after these words.
TEST_F(Help, CompletesWordsInBash) {
  if (!std::filesystem::exists("/bin/bash")) GTEST_SKIP() << "there is no bash";
  const auto offered = [&](const char* program, const std::vector<std::string>& words) {
    testing::writeBytes(folder / "complete", run(program, {"--help-as", "bash"}).out);
    std::string script = ". '" + (folder / "complete").string() + "'; COMP_WORDS=(";
    for (const std::string& word : words) script += "'" + word + "' ";
    script += fmt::format("); COMP_CWORD={}; {}; printf '%s\\n' \"${{COMPREPLY[@]}}\"", words.size() - 1,
                          words[0] == "lambent" ? "_lambent" : "_lambent_demo");
    const Outcome outcome = run("/bin/bash", {"-c", script});
    EXPECT_EQ(outcome.err, "");
    return outcome.out;
  };
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"lambent", "ba"}), "bake\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"lambent", "bake", "--qua"}), "--quality\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"lambent", "bake", "--quality", "d"}), "draft\n");
  EXPECT_EQ(offered(LAMBENT_PROGRAM, {"lambent", "info", "--js"}), "--json\n");
  EXPECT_EQ(offered(LAMBENT_DEMO, {"lambent-demo", "--headl"}), "--headless\n");
  EXPECT_EQ(offered(LAMBENT_DEMO, {"lambent-demo", "--quality", "h"}), "high\n");
}

}  // namespace lambent
