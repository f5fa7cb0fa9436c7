// Runs scripts that drive the editor (--script FILE). A line is a command of the command list with its
// words, an input to the window (click or drag at a mark, key, text, wheel, dropped file), a screenshot, or
// a wait. Each frame runs lines until one has to wait. Each answer is a line of JSON. A line that fails ends
// the script, unless it begins with "try". docs/editor.md lists the lines.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor/ui/ui.hpp"
#include "runtime/base/result.hpp"

namespace lambent::editor {

class Session;

struct ScriptLine {
  std::size_t number = 0;  // in the file, counted from 1
  bool may_fail = false;
  std::vector<std::string> words;  // the first is the command
};

// Parses a script. Blanks separate words; "..." keeps blanks, with \" and \\ for quotes and backslashes; #
// begins a comment.
Result<std::vector<ScriptLine>> parseScript(const std::filesystem::path& name, const std::string& text);

class Script {
 public:
  Script(std::filesystem::path name, std::vector<ScriptLine> lines, std::function<void(std::string)> answer);

  // Runs lines before a frame. Returns the input of that frame, or null if the script is over or leaves the
  // window to the user.
  const ScriptedInput* step(Session& session, Ui& ui);
  bool done() const { return at_ >= lines_.size() && queue_.empty(); }
  // Returns whether the line waits for a time to pass, which needs no frames.
  bool rests() const { return rests_; }
  // Returns the error of the line that failed, if one did.
  const std::optional<Error>& error() const { return error_; }

 private:
  enum class Progress { Done, Waits };
  Result<Progress> run(const ScriptLine& line, Session& session, Ui& ui, nlohmann::json& answer);
  Result<Progress> wait(const ScriptLine& line, Session& session);
  Result<glm::vec2> placeOf(const std::string& mark, const Ui& ui) const;
  void glide(glm::vec2 to, const ScriptedInput& held);
  void tap(const ScriptedInput& pressed);
  void finish(const ScriptLine& line, const nlohmann::json& answer, const Error* error);

  std::filesystem::path name_;
  std::vector<ScriptLine> lines_;
  std::function<void(std::string)> answer_;
  std::size_t at_ = 0;
  std::optional<Error> error_;
  bool started_ = false;  // the current line has queued its input or begun to wait
  bool rests_ = false;
  std::uint32_t frames_ = 0;
  std::chrono::steady_clock::time_point since_;
  std::deque<ScriptedInput> queue_;  // one for each frame
  std::optional<glm::vec2> pointer_;
  ScriptedInput now_;
  nlohmann::json last_;  // the last answer
};

}  // namespace lambent::editor
