#include "editor/script/script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>

#include "editor/commands/command.hpp"
#include "editor/session/session.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

// Returns the words of one line, or an error if a quote is not closed.
Result<std::vector<std::string>> wordsOf(const std::string& line, const std::string& place) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false, quoted = false;
  const auto end = [&] {
    if (!word.empty() || quoted) words.push_back(word);
    word.clear();
    quoted = false;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (inside && c == '\\' && i + 1 < line.size() && (line[i + 1] == '"' || line[i + 1] == '\\')) {
      word += line[++i];
    } else if (c == '"') {
      inside = !inside;
      quoted = true;
    } else if (!inside && c == '#' && word.empty()) {
      break;
    } else if (!inside && (c == ' ' || c == '\t' || c == '\r')) {
      end();
    } else {
      word += c;
    }
  }
  if (inside) return fail(place, "a quote is not closed", "end it with \"");
  end();
  return words;
}

}  // namespace

Result<std::vector<ScriptLine>> parseScript(const std::filesystem::path& name, const std::string& text) {
  std::vector<ScriptLine> lines;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    ++number;
    auto words = wordsOf(text.substr(begin, end - begin), fmt::format("{}:{}", name.string(), number));
    if (!words) return failAgain(words.error());
    begin = end + 1;
    if (words->empty()) continue;
    ScriptLine line{number, words->front() == "try", std::move(*words)};
    if (line.may_fail) line.words.erase(line.words.begin());
    if (!line.words.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

namespace {

constexpr int kGlideFrames = 6;                // frames of a drag, because widgets expect several moves
constexpr std::uint32_t kPatienceFrames = 20;  // frames to wait for a mark that the last line brings up
constexpr double kMostWaitSeconds = 600.0;

struct Waiting {
  const char* word;
  bool (*reached)(const Session&);
};
constexpr std::array kWaits = {Waiting{"loaded", [](const Session& s) { return s.loaded(); }},
                               Waiting{"baked", [](const Session& s) { return s.baked(); }},
                               Waiting{"rest", [](const Session& s) { return s.atRest(); }},
                               Waiting{"reference", [](const Session& s) { return s.reference.done(); }},
                               Waiting{"measured", [](const Session& s) { return s.measured(); }}};

Result<float> numberFrom(const ScriptLine& line, std::size_t index) {
  if (const auto number = spec::parseNumber(line.words[index])) return *number;
  return fail(line.words.front(), fmt::format("\"{}\" is not a number", line.words[index]), "give a number");
}

Result<nlohmann::json> screenshot(const std::filesystem::path& file, const spec::Rgba8Image& image) {
  if (auto written = spec::writePng(file, image); !written) return failAgain(written.error());
  return nlohmann::json{{"file", file.string()}, {"width", image.width}, {"height", image.height}};
}

// Implements "expect POINTER VALUE", which checks the last answer. Numbers must agree to a part in 10^4.
Result<void> expect(const ScriptLine& line, const nlohmann::json& last) {
  if (line.words.size() != 3)
    return fail("expect", "takes a place in the last answer and a value", "expect /selected/0 ball");
  try {
    const nlohmann::json& found = last.at(nlohmann::json::json_pointer(line.words[1]));
    const std::string text = found.is_string() ? found.get<std::string>() : found.dump();
    if (text == line.words[2]) return {};
    const auto wanted = spec::parseNumber(line.words[2]);
    if (found.is_number() && wanted &&
        std::abs(found.get<double>() - double{*wanted}) <= 1e-4 * std::max(1.0, std::abs(double{*wanted})))
      return {};
    return fail("expect", fmt::format("{} is {}, not {}", line.words[1], text, line.words[2]));
  } catch (const nlohmann::json::exception&) {
    return fail("expect", fmt::format("the last answer has no {}", line.words[1]), "it is " + last.dump());
  }
}

}  // namespace

Script::Script(std::filesystem::path name, std::vector<ScriptLine> lines,
               std::function<void(std::string)> answer)
    : name_(std::move(name)),
      lines_(std::move(lines)),
      answer_(std::move(answer)),
      since_(std::chrono::steady_clock::now()) {}

Result<glm::vec2> Script::placeOf(const std::string& mark, const Ui& ui) const {
  // A mark may be followed by a place within it: viewport@0.25,0.5.
  const std::size_t at = mark.rfind('@');
  const auto where = ui.marks().find(mark.substr(0, at));
  if (!where)
    return fail(mark, "is not on the screen",
                fmt::format("open its panel; on the screen are {}", fmt::join(ui.marks().names(), ", ")));
  if (!where->shown)
    return fail(mark, "lies outside what its panel shows",
                "make the panel larger, or scroll there with wheel");
  if (at == std::string::npos) return where->center();
  glm::vec2 share(0.5f);
  if (std::sscanf(mark.c_str() + at + 1, "%f,%f", &share.x, &share.y) != 2)
    return fail(mark, "has no place within it", "give NAME@X,Y with shares of its width and height");
  return where->min + share * (where->max - where->min);
}

void Script::glide(glm::vec2 to, const ScriptedInput& held) {
  const glm::vec2 from = pointer_.value_or(to);
  for (int i = 1; i <= kGlideFrames; ++i) {
    ScriptedInput input = held;
    input.pointer = glm::mix(from, to, static_cast<float>(i) / kGlideFrames);
    queue_.push_back(input);
  }
  pointer_ = to;
}

// The input is held for two frames and released for two: Dear ImGui reads a click in one and reacts in the
// next.
void Script::tap(const ScriptedInput& pressed) {
  queue_.insert(queue_.end(), 2, pressed);
  ScriptedInput released;
  released.pointer = pressed.pointer;
  queue_.insert(queue_.end(), 2, released);
}

Result<Script::Progress> Script::wait(const ScriptLine& line, Session& session) {
  const std::string kind = line.words.size() > 1 ? line.words[1] : "";
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count();
  if (kind == "frames" || kind == "seconds") {
    if (line.words.size() != 3) return fail("wait " + kind, "how many?", "wait " + kind + " 10");
    const auto count = numberFrom(line, 2);
    if (!count) return failAgain(count.error());
    // What the lines before did is drawn first.
    rests_ = kind == "seconds" && frames_ > 3;
    const bool reached =
        kind == "frames" ? double{*count} <= static_cast<double>(frames_) : seconds >= double{*count};
    return reached ? Progress::Done : Progress::Waits;
  }
  const auto found =
      std::find_if(kWaits.begin(), kWaits.end(), [&](const Waiting& w) { return kind == w.word; });
  if (found == kWaits.end())
    return fail("wait", fmt::format("\"{}\" is not known", kind),
                "wait for loaded, baked, rest, reference, measured, frames N or seconds S");
  double most = kMostWaitSeconds;
  if (line.words.size() > 2) {
    const auto given = numberFrom(line, 2);
    if (!given) return failAgain(given.error());
    most = double{*given};
  }
  // The effect of an earlier line may take a frame or two to show.
  if (frames_ >= 3 && found->reached(session)) return Progress::Done;
  if (seconds > most) return fail("wait " + kind, fmt::format("not reached in {} s", most));
  return Progress::Waits;
}

Result<Script::Progress> Script::run(const ScriptLine& line, Session& session, Ui& ui,
                                     nlohmann::json& answer) {
  const std::string& word = line.words.front();
  const std::size_t count = line.words.size();
  const bool pointing =
      word == "click" || word == "double-click" || word == "right-click" || word == "drag" || word == "hover";
  if (word == "wait") return wait(line, session);
  if (pointing || word == "key" || word == "type" || word == "wheel") {
    if (started_) return queue_.empty() ? Progress::Done : Progress::Waits;
    ScriptedInput input;
    const auto has = [&](std::string_view name) {
      return std::find(line.words.begin() + 1, line.words.end(), name) != line.words.end();
    };
    if (pointing) input.ctrl = has("Ctrl"), input.shift = has("Shift"), input.alt = has("Alt");
    if (pointing || word == "wheel") {
      if (count < 2) return fail(word, "at what?", "name a mark; \"marks\" lists them");
      const auto place = placeOf(line.words[1], ui);
      if (!place && frames_ < kPatienceFrames) return Progress::Waits;
      if (!place) return failAgain(place.error());
      glide(*place, {});
      input.pointer = *place;
    } else {
      if (count < 2) return fail(word, "what?", "key Ctrl+Z; type \"some text\"");
      input.pointer = pointer_;
    }
    if (word == "drag") {
      if (count < 4) return fail(word, "how far?", "drag MARK RIGHT DOWN, in pixels; or drag MARK to MARK");
      glm::vec2 to(0.0f);
      if (line.words[2] == "to") {
        const auto target = placeOf(line.words[3], ui);
        if (!target) return failAgain(target.error());
        to = *target;
      } else {
        const auto right = numberFrom(line, 2), down = numberFrom(line, 3);
        if (!right) return failAgain(right.error());
        if (!down) return failAgain(down.error());
        to = *input.pointer + glm::vec2(*right, *down);
      }
      input.right = has("right"), input.middle = has("middle"), input.left = !input.right && !input.middle;
      queue_.insert(queue_.end(), 2, input);
      glide(to, input);
      ScriptedInput released;
      released.pointer = to;
      queue_.insert(queue_.end(), 2, released);
    } else if (word == "click" || word == "double-click" || word == "right-click") {
      input.left = word != "right-click", input.right = !input.left;
      tap(input);
      input.again = word == "double-click";
      if (input.again) tap(input);
    } else if (word == "key") {
      const auto keys = parseShortcut(line.words[1]);
      if (!keys) return failAgain(keys.error());
      input.key = keys->key, input.ctrl = keys->ctrl, input.shift = keys->shift, input.alt = keys->alt;
      tap(input);
    } else if (word == "type") {
      input.text = line.words[1];
      queue_.push_back(input);
    } else if (word == "wheel") {
      const auto notches = count > 2 ? numberFrom(line, 2) : 1.0f;
      if (!notches) return failAgain(notches.error());
      input.wheel = *notches;
      queue_.push_back(input);
    }
    return Progress::Waits;
  }
  if (word == "drop") {
    for (std::size_t i = 1; i < count; ++i) ui.drop(line.words[i]);
    return Progress::Done;
  }
  if (word == "screenshot") {
    const auto image = ui.takePicture();
    if (!image) {
      // By then the effect of the last line is drawn.
      if (frames_ % 4 == 2) ui.askForPicture();
      return Progress::Waits;
    }
    auto taken = screenshot(count > 1 ? line.words[1] : "screenshot.png", *image);
    if (!taken) return failAgain(taken.error());
    answer = std::move(*taken);
    return Progress::Done;
  }
  if (word == "marks") {
    answer = ui.marks().names();
    return Progress::Done;
  }
  if (word == "where") {
    if (count < 2) return fail(word, "is what?", "name a mark; \"marks\" lists them");
    const auto mark = ui.marks().find(line.words[1]);
    if (!mark && frames_ < kPatienceFrames) return Progress::Waits;
    if (!mark) return fail(line.words[1], "is not on the screen");
    const glm::vec2 size = mark->max - mark->min;
    answer = {{"x", mark->min.x}, {"y", mark->min.y}, {"width", size.x}, {"height", size.y}};
    return Progress::Done;
  }
  if (word == "expect") {
    if (auto met = expect(line, last_); !met) return failAgain(met.error());
    answer = last_;
    return Progress::Done;
  }
  auto done = runCommand(session, word, Words(line.words).subspan(1));
  if (!done) return failAgain(done.error());
  answer = std::move(*done);
  return Progress::Done;
}

void Script::finish(const ScriptLine& line, const nlohmann::json& answer, const Error* error) {
  nlohmann::json row = {{"line", line.number}, {"command", fmt::format("{}", fmt::join(line.words, " "))}};
  row["ok"] = error == nullptr;
  if (error)
    row["error"] = error->line();
  else if (!answer.is_null())
    row["answer"] = answer;
  if (error && !line.may_fail) {
    error_ = Error{fmt::format("{}:{}: {}", name_.string(), line.number, error->subject), error->problem,
                   error->hint};
    at_ = lines_.size();
  } else {
    ++at_;
  }
  last_ = error ? nlohmann::json{{"error", error->line()}} : answer;
  started_ = false;
  answer_(row.dump());
}

const ScriptedInput* Script::step(Session& session, Ui& ui) {
  ++frames_;
  rests_ = false;
  while (queue_.empty() && at_ < lines_.size()) {
    const ScriptLine& line = lines_[at_];
    nlohmann::json answer;
    const auto progress = run(line, session, ui, answer);
    if (progress && *progress == Progress::Waits) {
      started_ = !queue_.empty();
      break;
    }
    finish(line, answer, progress ? nullptr : &progress.error());
    frames_ = 0;
    since_ = std::chrono::steady_clock::now();
  }
  if (!queue_.empty()) rests_ = false;
  if (queue_.empty() && done()) return nullptr;
  now_ = {};
  if (!queue_.empty()) {
    now_ = std::move(queue_.front());
    queue_.pop_front();
  }
  if (!now_.pointer) now_.pointer = pointer_;
  return &now_;
}

}  // namespace lambent::editor
