#include "editor/app/run.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "editor/app/layout.hpp"
#include "editor/commands/command.hpp"
#include "editor/render/renderer.hpp"
#include "editor/script/script.hpp"
#include "editor/session/status.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/gpu/context.hpp"

namespace lambent::editor {

namespace {

using Clock = std::chrono::steady_clock;

// The longest sleep while nothing moves, after which files and bakes are checked.
constexpr double kRestWaitSeconds = 0.1;
// The loop does not sleep for this long after an input, because widgets may still animate.
constexpr double kActiveSeconds = 0.5;

Result<std::optional<Script>> loadScript(const Options& options) {
  if (!options.script) return std::nullopt;
  const auto text = readTextFile(*options.script);
  if (!text) return failAgain(text.error());
  auto lines = parseScript(*options.script, *text);
  if (!lines) return failAgain(lines.error());
  const bool json = options.json;
  return Script(*options.script, std::move(*lines), [json](const std::string& answer) {
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

}  // namespace

Result<void> run(const Options& options) {
  auto script = loadScript(options);
  if (!script) return failAgain(script.error());
  const std::filesystem::path remembered = options.remember ? preferencesFile() : std::filesystem::path{};
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
  if (!options.script)
    s.window.desktop_program = desktopDialogProgram();  // no script answers another program
  Ui ui(*window, s.preferences.scale);
  s.clipboard.put_system = [](const std::string& text) { ImGui::SetClipboardText(text.c_str()); };
  s.clipboard.get_system = [] {
    const char* text = ImGui::GetClipboardText();
    return std::string(text ? text : "");
  };

  s.viewing.surface_ahead = [&s, &r = *renderer]() -> std::optional<glm::vec3> {
    const spec::Size size = s.viewing.size;
    const auto picked =
        r.pick(s, 0.5f * static_cast<float>(size.width), 0.5f * static_cast<float>(size.height));
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
    const bool awaits = s.awaits();
    if (!woken && !awaits && !std::exchange(awaited, false) && !s.moving() && !ui.typing()) continue;
    awaited = awaits;
    ui.begin(scripted);
    if (ui.closeRequested()) {
      ui.refuseClose();
      s.files.askToQuit();
    }
    std::vector<std::filesystem::path> dropped;
    for (const std::filesystem::path& file : ui.takeDropped())
      if (const auto asset = assetAt(file); asset && asset->kind == AssetKind::EnvironmentMap)
        runOrLog(s, "use-asset", std::array{file.string()});
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
  s.preferences.handles = s.handles.gizmo.options;
  savePreferences(remembered, s.preferences);
  if (*script && (*script)->failed()) return failAgain((*script)->error());
  return {};
}

}  // namespace lambent::editor
