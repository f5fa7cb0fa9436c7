// Plays scripts in the editor's window, under Xvfb, and reads its answers.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"
#include "tests/support/require.hpp"
#include "tests/support/x_server.hpp"

namespace lambent::testing {

// Returns everything known about a run, for messages.
inline std::string told(const Outcome& outcome) {
  return fmt::format("exit code {}\n--- stderr\n{}--- stdout\n{}", outcome.exit_code, outcome.err,
                     outcome.out);
}

struct Played {
  Outcome outcome;
  std::vector<nlohmann::json> answers;  // a line each

  // Returns the last answer to this command.
  const nlohmann::json& answer(const std::string& command) const {
    for (auto line = answers.rbegin(); line != answers.rend(); ++line)
      if ((*line)["command"].get<std::string>().starts_with(command)) return (*line)["answer"];
    static const nlohmann::json kNone;
    return kNone;
  }
  // Returns all answers to this command, in order.
  std::vector<nlohmann::json> all(const std::string& command) const {
    std::vector<nlohmann::json> found;
    for (const nlohmann::json& line : answers)
      if (line["command"].get<std::string>().starts_with(command)) found.push_back(line["answer"]);
    return found;
  }
};

class EditorProgram : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
    // Each run uses its own display; without Xvfb it uses the user's.
    std::string why;
    display = XServer::start(why);
    if (display)
      ::setenv("DISPLAY", display->display().c_str(), 1);
    else if (const char* given = std::getenv("DISPLAY"); !given || !*given)
      LAMBENT_LACKS("display", "there is no display: " << why);
    std::filesystem::copy(LAMBENT_BINARY_DIR "/assets/hello.glb", folder / "hello.glb");
  }

  Played play(const std::string& script, std::vector<std::string> arguments = {}) {
    writeBytes(folder / "test.script", script);
    std::vector<std::string> words = {"--script",
                                      (folder / "test.script").string(),
                                      "--json",
                                      "--cache",
                                      (folder / "cache").string(),
                                      "--size",
                                      size,
                                      "--quality",
                                      "draft"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    Played played{run(LAMBENT_EDITOR, words), {}};
    std::istringstream lines(played.outcome.out);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with('{')) played.answers.push_back(nlohmann::json::parse(line));
    EXPECT_EQ(played.outcome.exit_code, fails ? 1 : 0) << told(played.outcome);
    return played;
  }
  // Plays the script in a small window, when hello.glb was opened and is shown without a bake.
  Played playInHello(const std::string& script, std::vector<std::string> arguments = {}) {
    size = "900x600";
    arguments.emplace_back("--no-bake");
    return play(fmt::format("open {}\nwait loaded 60\n", path("hello.glb")) + script, std::move(arguments));
  }
  std::string path(const char* name) const { return (folder / name).string(); }

  bool fails = false;  // whether scripts end by an error
  std::string size = "1280x800";
  std::unique_ptr<XServer> display;
};

}  // namespace lambent::testing

namespace lambent {

using nlohmann::json;
using testing::EditorProgram;
using testing::Played;
using testing::told;

}  // namespace lambent
