#include "runtime/demo/options.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "runtime/base/lower_case.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::demo {

namespace {

// The raw strings from CLI11, before they are parsed.
struct Words {
  std::vector<std::string> bundles, lights, fade_lights, key_edits;
  std::string light_layout, camera, size = "1280x720", headless, view = "final", overlay, quality = "default";
  std::string rotate_light = "0", lamps = "1", fade = "0", time, step = "0.0333";
  std::vector<std::string> settings;  // of the frame, one per row
  std::uint64_t max_memory = ~std::uint64_t{0};
  std::uint32_t frames = 1;
  bool json = false;
};

struct Row {
  const char* name;
  std::string Words::*field;
  const char* type;
  const char* help;
};

constexpr Row kRows[] = {
    {"--light-layout", &Words::light_layout, "LAYOUT",
     "Layout of environment maps whose shape misleads: lat-long, angular-map\nor vertical-cross"},
    {"--camera", &Words::camera, "CAM",
     "Name or index of a camera in the file, or orbit:AZ,EL,DIST,FOV\n(default: the file's first, else an "
     "orbit)"},
    {"--size", &Words::size, "WxH", "Picture or window in pixels"},
    {"--headless", &Words::headless, "OUT",
     "Write one picture (.png tone-mapped, .exr linear) without a display;\nwith a run of # in its name "
     "every "
     "frame: out-###.png"},
    {"--view", &Words::view, "NAME",
     "What surfaces show: final, irradiance, transfer-dc,\ntransfer-band[:BAND], error, clusters, normals or "
     "wireframe;\nan "
     ".exr holds the numbers"},
    {"--overlay", &Words::overlay, "LIST",
     "Drawn over the picture: light-probes, neighborhoods[:AXIS,POSITION],\nvolumes, groups, lights, keys"},
    {"--rotate-light", &Words::rotate_light, "DEG", "Turn all lights about +Y (+Z towards +X)"},
    {"--fade", &Words::fade, "SHARE", "From the lights of --light to those of --fade-to: 0..1"},
    {"--time", &Words::time, "S",
     "Where the scenes' animations stand in the last frame, in\nseconds (default: headless, the scenes at "
     "rest)"},
    {"--step", &Words::step, "S", "Seconds of animation from frame to frame, headless"},
    {"--lamps", &Words::lamps, "FACTOR", "Times the strength of the scenes' own lights; 0 switches them off"},
};

// Returns the type of an option as help shows it.
std::string typeOf(const frame::SettingRow& row) {
  switch (row.kind) {
    case frame::SettingRow::Kind::Switch:
      return "on|off";
    case frame::SettingRow::Kind::Choice:
      return fmt::format("{}", fmt::join(row.words, "|"));
    case frame::SettingRow::Kind::Whole:
      return "N";
    case frame::SettingRow::Kind::Real:
      break;
  }
  return "NUMBER";
}

void declare(CLI::App& app, Words& words) {
  app.add_option("BUNDLE", words.bundles, "Baked scenes to show (.lmb.glb), or folders of them")
      ->required()
      ->type_name("");
  app.add_option("--light", words.lights,
                 "Several add up: an environment map file (.hdr, .exr), constant:R,G,B "
                 "or\nsun:AZ,EL,ANGLE,R[,G,B] (degrees, "
                 "angular radius, radiance);\nin the scene: sphere:X,Y,Z,RADIUS,R[,G,B] or "
                 "disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]")
      ->type_name("LIGHT")
      ->take_all()
      ->expected(1);
  app.add_option("--fade-to", words.fade_lights,
                 "Lights from infinity to fade to, see --fade; several add up")
      ->type_name("LIGHT")
      ->take_all()
      ->expected(1);
  app.add_option(
         "--edit-key", words.key_edits,
         "key:AZ,EL,TO_AZ,TO_EL,R[,G,B]: the key light that was found in a\nprobe at AZ,EL stands at "
         "TO_AZ,TO_EL and shines by these factors\n(--json lists the key lights); several edit several")
      ->type_name("EDIT")
      ->take_all()
      ->expected(1);
  for (const Row& row : kRows) {
    CLI::Option* option = app.add_option(row.name, words.*row.field, row.help)->type_name(row.type);
    if (!(words.*row.field).empty()) option->capture_default_str();
  }
  const frame::FrameSettings defaults;
  words.settings.resize(frame::settingRows().size());  // empty: not given, so --quality decides
  for (std::size_t i = 0; i < words.settings.size(); ++i) {
    const frame::SettingRow& row = frame::settingRows()[i];
    app.add_option("--" + std::string(row.name), words.settings[i], std::string(row.help))
        ->type_name(typeOf(row))
        ->default_str(frame::settingWord(row, defaults));
    if (!row.former.empty())
      app.add_option("--" + std::string(row.former), words.settings[i])->group("");  // hidden in help
  }
  app.add_option("--quality", words.quality,
                 "How many key lights there are and how finely\nthey shadow; single "
                 "options go before it")
      ->type_name("low|default|high")
      ->capture_default_str();
  app.add_option("--frames", words.frames,
                 "Frames to render headless, the last one is written or, with # in\nthe name, every one; the "
                 "light turns through "
                 "--rotate-light and time goes on over them")
      ->type_name("N")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1'000'000u).description(""));
  app.add_option("--max-memory", words.max_memory,
                 "GPU memory for the scenes, in bytes or like 200MB; what the camera\nsees large comes first "
                 "(default: no limit)")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
  app.add_flag("--json", words.json, "Report on stdout: times, counts, bytes resident");
}

// Puts the options in groups, with examples.
void describe(CLI::App& app) {
  command_line::group(
      app, "Light",
      {"--light", "--light-layout", "--rotate-light", "--fade-to", "--fade", "--edit-key", "--lamps"});
  command_line::group(app, "Picture",
                      {"--camera", "--size", "--headless", "--frames", "--view", "--overlay"});
  command_line::group(app, "Animation", {"--time", "--step"});
  command_line::group(app, "Accuracy and effects", {"--quality"});
  for (const frame::SettingRow& row : frame::settingRows())
    command_line::group(app, "Accuracy and effects", {"--" + std::string(row.name)});
  command_line::group(app, "Machine", {"--max-memory"});
  command_line::group(app, "Output", {"--json"});
  command_line::addExamples(
      app,
      {{"lambent-demo scene.lmb.glb --light sky.hdr", "shows a bundle in a window"},
       {"lambent-demo bundles --light sun:40,30,0.27,20 --light constant:0.3,0.4,0.6",
        "shows all bundles of a folder under a sun and an even sky"},
       {"lambent-demo scene.lmb.glb --headless out-###.png --frames 100 --rotate-light 360",
        "draws a turn of the light without a display"}},
      "In the window: drag turns the camera, the wheel moves it, R resets it; the right button drags the "
      "first light that stands in the scene; space stops lights and animations, A and D turn the lights; H "
      "shows the keys; Esc quits.");
  command_line::finish(app, "lambent-demo " LAMBENT_VERSION);
}

Result<void> understandLights(const Words& words, Options& options) {
  options.default_light = words.lights.empty();
  options.light_words = words.lights;
  if (options.default_light)
    options.light_words.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  auto lights = spec::parseLights(options.light_words, words.light_layout);
  if (!lights) return failAgain(lights.error());
  options.lights = std::move(*lights);
  options.fade_words = words.fade_lights;
  auto fade_lights = spec::parseLights(options.fade_words, words.light_layout);
  if (!fade_lights) return failAgain(fade_lights.error());
  options.fade_lights = std::move(*fade_lights);
  if (!spec::localLights(options.fade_lights).empty())
    return fail("--fade-to", "takes lights from infinity only", "give spheres and discs with --light");
  for (const std::string& word : words.key_edits) {
    const Result<spec::KeyEdit> edit = spec::parseKeyEdit(word);
    if (!edit) return failAgain(edit.error());
    options.key_edits.push_back(*edit);
  }
  const std::optional<float> fade = spec::parseNumber(words.fade);
  if (!fade || *fade < 0.0f || *fade > 1.0f)
    return fail("--fade", fmt::format("\"{}\" is not a share", words.fade), "give 0..1");
  if (*fade > 0.0f && options.fade_lights.empty())
    return fail("--fade", "there is nothing to fade to", "give lights with --fade-to");
  options.fade = *fade;
  return {};
}

Result<float> understandSeconds(const char* option, const std::string& word, float low, float high) {
  const std::optional<float> seconds = spec::parseNumber(word);
  if (!seconds || !(*seconds >= low && *seconds <= high))
    return fail(option, fmt::format("\"{}\" is not a number of seconds", word),
                fmt::format("give {}..{}", low, high));
  return *seconds;
}

Result<void> understandPicture(const Words& words, Options& options) {
  const Result<spec::Size> size = spec::parseSize(words.size);
  if (!size) return failAgain(size.error());
  options.size = *size;
  if (!words.camera.empty()) {
    const Result<spec::Camera> camera = spec::parseCamera(words.camera);
    if (!camera) return failAgain(camera.error());
    options.camera = *camera;
  }
  if (!words.headless.empty()) {
    options.headless = words.headless;
    const std::string extension = lowerCase(options.headless->extension().string());
    if (extension != ".png" && extension != ".exr")
      return fail("--headless", fmt::format("\"{}\" is neither .png nor .exr", words.headless),
                  "name a .png (tone-mapped) or an .exr (linear)");
    options.linear = extension == ".exr";
  }
  return {};
}

// Returns the bundle, or those in the folder sorted by name.
Result<std::vector<std::filesystem::path>> bundlesIn(const std::filesystem::path& word) {
  std::error_code error;
  if (!std::filesystem::is_directory(word, error)) return std::vector{word};
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(word, error))
    if (entry.path().string().ends_with(".lmb.glb")) found.push_back(entry.path());
  if (error) return fail(word.string(), "cannot be read: " + error.message());
  if (found.empty()) return fail(word.string(), "has no .lmb.glb in it", "bake a scene into it first");
  std::ranges::sort(found);
  return found;
}

Result<Options> understand(const Words& words) {
  Options options;
  for (const std::string& word : words.bundles) {
    const Result<std::vector<std::filesystem::path>> found = bundlesIn(word);
    if (!found) return failAgain(found.error());
    options.bundles.insert(options.bundles.end(), found->begin(), found->end());
  }
  if (Result<void> done = understandLights(words, options); !done) return failAgain(done.error());
  if (Result<void> done = understandPicture(words, options); !done) return failAgain(done.error());
  const Result<frame::FrameSettings> settings = frame::settingsOfQuality(words.quality);
  if (!settings) return failAgain(settings.error());
  options.settings = *settings;
  for (std::size_t i = 0; i < words.settings.size(); ++i) {
    if (words.settings[i].empty()) continue;
    if (Result<void> done =
            frame::putSetting(options.settings, frame::settingRows()[i].name, words.settings[i]);
        !done)
      return failAgain(done.error());
  }
  const Result<frame::ViewChoice> view = frame::parseView(words.view);
  if (!view) return fail("--view", view.error().problem, view.error().hint);
  options.view = *view;
  Result<frame::OverlayOptions> overlays = frame::parseOverlays(words.overlay);
  if (!overlays) return fail("--overlay", overlays.error().problem, overlays.error().hint);
  options.overlays = std::move(*overlays);
  const Result<float> turn = spec::parseDegrees(words.rotate_light);
  if (!turn) return failAgain(turn.error());
  const std::optional<float> lamps = spec::parseNumber(words.lamps);
  if (!lamps || *lamps < 0.0f || *lamps > 1e6f)
    return fail("--lamps", fmt::format("\"{}\" is not a factor", words.lamps), "give 0..1000000");
  options.lamps = *lamps;
  if (!words.time.empty()) {
    const Result<float> time = understandSeconds("--time", words.time, 0.0f, 1e6f);
    if (!time) return failAgain(time.error());
    options.time_s = *time;
  }
  const Result<float> step = understandSeconds("--step", words.step, 0.0f, 1e3f);
  if (!step) return failAgain(step.error());
  options.step_s = *step;
  options.max_memory_bytes = words.max_memory;
  options.rotate_light_deg = *turn;
  options.frames = words.frames;
  options.json = words.json;
  return options;
}

}  // namespace

void printError(const Error& error) {
  fmt::print(stderr, "lambent-demo: {}\n", error.line());
}

std::variant<Options, int> parseOptions(int argc, const char* const* argv) {
  CLI::App app("Shows baked scenes under light that changes: in a window, or as a picture with --headless.",
               "lambent-demo");
  Words words;
  declare(app, words);
  describe(app);
  if (const auto ended = command_line::parse(app, argc, argv)) return *ended;
  Result<Options> options = understand(words);
  if (options) return std::move(*options);
  printError(options.error());
  return 2;
}

}  // namespace lambent::demo
