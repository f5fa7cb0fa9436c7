// lambent-editor: opens, bakes and lights scenes. Exit codes: 0 done, 1 failed, 2 wrong usage.
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/commands/command.hpp"
#include "editor/panels/panel.hpp"
#include "editor/render/renderer.hpp"
#include "editor/script/script.hpp"
#include "editor/session/scene_changes.hpp"
#include "editor/session/session.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {
namespace {

struct Options {
  SessionOptions session;
  std::vector<std::string> files;
  std::string size, script, cache, output, quality = "standard";
  bool json = false, fresh = false, no_bake = false;
  float scale = 0.0f;         // of text and widgets; 0: as remembered
  int width = 0, height = 0;  // in pixels; 0: as remembered
};

void declare(CLI::App& app, Options& words) {
  app.add_option("FILE", words.files,
                 "Scenes (.gltf, .glb), bundles (.lmb.glb), folders of them,\nor a world (.json)")
      ->type_name("");
  app.add_option("--light", words.session.light_words,
                 "Several add up: an environment map file (.hdr, .exr), constant:R,G,B "
                 "or\nsun:AZ,EL,ANGLE,R[,G,B]; in "
                 "the scene: sphere:... or disc:...")
      ->type_name("LIGHT")
      ->take_all()
      ->expected(1);
  app.add_option("--size", words.size, "Window in pixels (default: as it was)")->type_name("WxH");
  app.add_option("--scale", words.scale, "Size of text and widgets, 0.5..4 (default: as it was)")
      ->type_name("FACTOR")
      ->check(CLI::Range(0.5f, 4.0f).description(""));
  app.add_option("--quality", words.quality, "Of the final bake")
      ->capture_default_str()
      ->type_name("draft|standard|high")
      ->check(CLI::IsMember({"draft", "standard", "high"}).description(""));
  app.add_option("-o,--output", words.output, "Folder for the bundles of scenes (default: beside each scene)")
      ->type_name("DIR");
  app.add_option("--cache", words.cache,
                 "Folder for what bakes keep (default: $LAMBENT_CACHE, else\n$XDG_CACHE_HOME/lambent, else "
                 "~/.cache/lambent)")
      ->type_name("DIR");
  app.add_option("--cache-size", words.session.cache_bytes, "What it may hold, in bytes or like 4GB")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
  app.add_option("--max-memory", words.session.max_memory_bytes,
                 "GPU memory for bundles, in bytes or like 200MB")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
  app.add_option("--threads", words.session.threads, "Threads of bakes (default: all but one)")
      ->type_name("N");
  app.add_flag("--no-bake", words.no_bake, "Show scenes without transfer, and bake only when asked to");
  app.add_option("--script", words.script, "Run the commands of a file, then quit (docs/editor.md)")
      ->type_name("FILE");
  app.add_flag("--json", words.json, "The script's answers on stdout, a JSON value a line");
  app.add_flag("--fresh", words.fresh, "Forget layout and recent files, and remember none");
  command_line::group(app, "Light", {"--light"});
  command_line::group(app, "Window", {"--size", "--scale", "--fresh"});
  command_line::group(app, "Bakes", {"--quality", "--output", "--no-bake", "--threads"});
  command_line::group(app, "Memory and cache", {"--cache", "--cache-size", "--max-memory"});
  command_line::group(app, "Scripts", {"--script", "--json"});
  command_line::addExamples(
      app, {{"lambent-editor scene.gltf", "shows a scene while it bakes"},
            {"lambent-editor scenes -o bundles --quality draft", "bakes what is in a folder, as it changes"},
            {"lambent-editor --script commands.txt --json", "runs commands and quits"}});
  command_line::finish(app, "lambent-editor " LAMBENT_VERSION);
}

// Takes what the words say over into the other members.
Result<void> understand(Options& options) {
  SessionOptions& session = options.session;
  if (const auto lights = spec::parseLights(session.light_words); !lights) return failAgain(lights.error());
  if (!options.size.empty()) {
    const auto size = spec::parseSize(options.size);
    if (!size) return failAgain(size.error());
    options.width = static_cast<int>(size->width), options.height = static_cast<int>(size->height);
  }
  session.files.assign(options.files.begin(), options.files.end());
  session.quality = options.quality == "draft"  ? baker::Quality::Draft
                    : options.quality == "high" ? baker::Quality::High
                                                : baker::Quality::Standard;
  session.output_folder = options.output;
  session.cache_folder = options.cache;
  session.bake = !options.no_bake;
  return {};
}

void printError(const Error& error) {
  fmt::print(stderr, "lambent-editor: {}\n", error.line());
}

// Reads the command line. Returns the exit code with which to stop, after --help and --version (0) or after
// one line on stderr that says what is wrong and what to do (2), or else the options.
std::variant<Options, int> parseOptions(int argc, const char* const* argv) {
  CLI::App app("Opens, bakes and lights scenes, and shows what accuracy costs.", "lambent-editor");
  Options options;
  declare(app, options);
  if (const auto ended = command_line::parse(app, argc, argv)) return *ended;
  const Result<void> understood = understand(options);
  if (understood) return options;
  printError(understood.error());
  return 2;
}

using Clock = std::chrono::steady_clock;

// The longest sleep while nothing moves, after which files and bakes are checked.
constexpr double kRestWaitSeconds = 0.1;
// The loop does not sleep for this long after an input, because widgets may still animate.
constexpr double kActiveSeconds = 0.5;

Result<std::optional<Script>> loadScript(const Options& options) {
  if (options.script.empty()) return std::nullopt;
  const auto text = readTextFile(options.script);
  if (!text) return failAgain(text.error());
  auto lines = parseScript(options.script, *text);
  if (!lines) return failAgain(lines.error());
  const bool json = options.json;
  return Script(options.script, std::move(*lines), [json](const std::string& answer) {
    if (!json) return;
    fmt::print("{}\n", answer);
    std::fflush(stdout);
  });
}

// Saves what is not saved, and returns the error with where it lies.
Result<void> afterLoss(Session& session, Error lost) {
  const Result<std::filesystem::path> rescued = session.files.rescue();
  if (!rescued)
    lost.problem += fmt::format("; what was not saved is lost: {}", rescued.error().line());
  else if (!rescued->empty())
    lost.hint = fmt::format("what was not saved lies in {}", rescued->string());
  return failAgain(std::move(lost));
}

// Takes input and outside changes (files, bakes), steps the world, and draws the picture and the panels. It
// sleeps while nothing moves. Errors: no window can be opened; the script cannot be read, or one of its lines
// failed.
Result<void> run(const Options& options) {
  auto script = loadScript(options);
  if (!script) return failAgain(script.error());
  const std::filesystem::path remembered = options.fresh ? std::filesystem::path{} : preferencesFile();
  Preferences preferences = loadPreferences(remembered);
  if (options.width > 0) preferences.width = options.width, preferences.height = options.height;
  if (options.scale > 0.0f) preferences.scale = options.scale;

  auto window = gpu::Window::create("Lambent", static_cast<std::uint32_t>(preferences.width),
                                    static_cast<std::uint32_t>(preferences.height), {});
  if (!window)
    return fail(window.error().subject, window.error().problem,
                "start it where there is a display, or under xvfb-run");
  auto session = Session::create(options.session, std::move(preferences));
  if (!session) return failAgain(session.error());
  Session& s = **session;
  auto renderer = Renderer::create(s);
  if (!renderer) return failAgain(renderer.error());
  Ui ui(*window, s.preferences.scale);
  s.viewing.surface_ahead = [&s, &r = *renderer]() -> std::optional<glm::vec3> {
    const spec::Size size = s.viewing.size;
    const auto picked =
        r.picture.pick(s, 0.5f * static_cast<float>(size.width), 0.5f * static_cast<float>(size.height));
    return picked && *picked ? std::optional((*picked)->position_ws) : std::nullopt;
  };

  Clock::time_point last = Clock::now();
  bool moving = true, awaited = true;
  std::string title;
  while (!s.window.quit) {
    const ScriptedInput* scripted = *script ? (*script)->step(s, ui) : nullptr;
    if (*script && (*script)->done() && scripted == nullptr) break;
    const bool rests = !moving && (!*script || (*script)->rests()) && ui.sinceInput() > kActiveSeconds;
    const bool woken = !rests || ui.wait(kRestWaitSeconds);
    const auto now = Clock::now();
    s.update(std::chrono::duration<double>(now - last).count());
    last = now;
    // The last frame shows what was awaited, so there is one more when it has come.
    const bool awaits = s.scenes.busy();
    if (!woken && !awaits && !std::exchange(awaited, false) && !s.moving() && !ui.typing()) continue;
    awaited = awaits;
    ui.begin(scripted);
    if (ui.closeRequested()) {
      ui.refuseClose();
      s.files.askToQuit();
    }
    std::vector<std::filesystem::path> dropped;
    for (const std::filesystem::path& file : ui.takeDropped())
      if (isEnvironmentMap(file.string()))
        runOrLog(s, "environment-map", std::array{file.string()});
      else
        dropped.push_back(file);  // also a folder, or what cannot be opened
    if (!dropped.empty()) s.files.openLogged(dropped);
    drawLayout(s, *renderer, ui.marks());
    moving = s.moving();
    ui.end();
    ++s.window.frames;
    if (auto drawn = gpu::checkContext(); !drawn) return afterLoss(s, drawn.error());
    if (titleOf(s) != title) window->setTitle(title = titleOf(s));
  }
  std::uint32_t width = 0, height = 0;
  window->framebufferSize(width, height);
  s.preferences.width = static_cast<int>(width), s.preferences.height = static_cast<int>(height);
  savePreferences(remembered, s.preferences);
  if (*script && (*script)->error()) return failAgain(*(*script)->error());
  return {};
}

}  // namespace
}  // namespace lambent::editor

int main(int argc, char** argv) {
  using namespace lambent;
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows past the user's limit is an error of that file
  try {
    const auto parsed = editor::parseOptions(argc, argv);
    if (const int* exit_code = std::get_if<int>(&parsed)) return *exit_code;
    const Result<void> done = editor::run(std::get<editor::Options>(parsed));
    if (done) return 0;
    editor::printError(done.error());
  } catch (const gpu::OutOfMemory& failure) {
    editor::printError(failure.error());
  } catch (const std::exception& error) {  // out of memory, mostly
    editor::printError({.subject = "stopped", .problem = error.what(), .hint = {}});
  }
  return 1;
}
