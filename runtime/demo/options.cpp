#include <algorithm>
#include <cstdio>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "runtime/base/lower_case.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/demo/stage.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::demo {

namespace {

// Words that mean something only together with others.
struct Words {
  std::vector<std::string> bundles, key_edits;
  std::string light_layout;
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

// Returns a parser of numbers from 0 to `most`, which are `what`.
auto numberUpTo(float most, const char* option, const char* what) {
  return [=](const std::string& word) -> Result<float> {
    const std::optional<float> number = spec::parseNumber(word);
    if (number && *number >= 0.0f && *number <= most) return *number;
    return fail(option, fmt::format("\"{}\" is not {}", word, what), fmt::format("give 0..{}", most));
  };
}

// Returns the parser with the option's name in its errors.
template <class Parse>
auto named(const char* option, Parse parse) {
  return [=](const std::string& word) {
    auto parsed = parse(word);
    if (!parsed) parsed.error().subject = option;
    return parsed;
  };
}

Result<void> takePicture(const std::string& word, Options& options) {
  options.headless = word;
  const std::string extension = lowerCase(options.headless->extension().string());
  options.linear = extension == ".exr";
  if (extension == ".png" || options.linear) return {};
  return fail("--headless", fmt::format("\"{}\" is neither .png nor .exr", word),
              "name a .png (tone-mapped) or an .exr (linear)");
}

void declare(CLI::App& app, Options& options, Words& words) {
  using command_line::addWord, command_line::addWords, command_line::into;
  app.add_option("BUNDLE", words.bundles, "Baked scenes to show (.lmb.glb), or folders of them")
      ->required()
      ->type_name("");
  addWords(app, "--light", options.light_words, "LIGHT",
           "Several add up: an environment map file (.hdr, .exr), constant:R,G,B or "
           "sun:AZ,EL,ANGLE,R[,G,B] (degrees, angular radius, radiance); in the scene: "
           "sphere:X,Y,Z,RADIUS,R[,G,B] or disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]");
  addWords(app, "--fade-to", options.fade_words, "LIGHT",
           "Lights from infinity to fade to, see --fade; several add up");
  addWords(app, "--edit-key", words.key_edits, "EDIT",
           "key:AZ,EL,TO_AZ,TO_EL,R[,G,B]: the key light that was found in a probe at AZ,EL stands at "
           "TO_AZ,TO_EL and shines by these factors (--json lists the key lights); several edit several");
  command_line::addValue(app, "--light-layout", words.light_layout, "LAYOUT",
                         "Layout of environment maps whose shape misleads: lat-long, angular-map or "
                         "vertical-cross");
  addWord(app, "--camera", "CAM",
          "Name or index of a camera in the file, or orbit:AZ,EL,DIST,FOV (default: the file's first, else "
          "an orbit)",
          into(options.camera, spec::parseCamera));
  addWord(app, "--size", "WxH", "Picture or window in pixels", into(options.size, spec::parseSize))
      ->default_str("1280x720");
  addWord(app, "--headless", "OUT",
          "Write one picture (.png tone-mapped, .exr linear) without a display; with a run of # in its name "
          "every frame: out-###.png",
          [&](const std::string& word) { return takePicture(word, options); });
  addWord(app, "--view", "NAME",
          "What surfaces show: final, irradiance, transfer-dc, error, clusters, normals "
          "or wireframe; an .exr holds the numbers",
          into(options.view, named("--view", frame::parseView)))
      ->default_str("final");
  addWord(app, "--overlay", "LIST",
          "Drawn over the picture: light-probes, neighborhoods, volumes, groups, lights, keys",
          into(options.overlays, named("--overlay", frame::parseOverlays)));
  addWord(app, "--rotate-light", "DEG", "Turn all lights about +Y (+Z towards +X)",
          into(options.rotate_light_deg, spec::parseDegrees))
      ->default_str("0");
  addWord(app, "--fade", "SHARE", "From the lights of --light to those of --fade-to: 0..1",
          into(options.fade, numberUpTo(1.0f, "--fade", "a share")))
      ->default_str("0");
  addWord(
      app, "--time", "S",
      "Where the scenes' animations stand in the last frame, in seconds (default: headless, the scenes at "
      "rest)",
      into(options.time_s, numberUpTo(1e6f, "--time", "a number of seconds")));
  addWord(app, "--step", "S", "Seconds of animation from frame to frame, headless",
          into(options.step_s, numberUpTo(1e3f, "--step", "a number of seconds")))
      ->default_str("0.0333");
  addWord(app, "--lamps", "FACTOR", "Times the strength of the scenes' own lights; 0 switches them off",
          into(options.lamps, numberUpTo(1e6f, "--lamps", "a factor")))
      ->default_str("1");
  // The library takes options over in this order, so that single ones go before --quality.
  addWord(app, "--quality", "low|default|high",
          "How many key lights there are and how finely they shadow; single options go before it",
          into(options.settings, frame::settingsOfQuality))
      ->default_str("default");
  for (const frame::SettingRow& row : frame::settingRows()) {
    const auto put = [&](const std::string& word) {
      return frame::putSetting(options.settings, row.name, word);
    };
    addWord(app, "--" + std::string(row.name), typeOf(row), std::string(row.help), put)
        ->default_str(frame::settingWord(row, {}));
    if (!row.former.empty()) addWord(app, "--" + std::string(row.former), "", "", put)->group("");  // hidden
  }
  command_line::addValue(app, "--frames", options.frames, "N",
                         "Frames to render headless, the last one is written or, with # in the name, every "
                         "one; the light turns through --rotate-light and time goes on over them")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1'000'000u).description(""));
  command_line::addBytes(
      app, "--max-memory", options.max_memory_bytes,
      "GPU memory for the scenes, in bytes or like 200MB; what the camera sees large comes "
      "first (default: no limit)");
  app.add_flag("--json", options.json, "Report on stdout: times, counts, bytes resident");
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
      "prints the keys; Esc quits.");
  command_line::finish(app, "lambent-demo " LAMBENT_VERSION);
}

Result<void> understandLights(const Words& words, Options& options) {
  options.default_light = options.light_words.empty();
  if (options.default_light)
    options.light_words.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  auto lights = spec::parseLights(options.light_words, words.light_layout);
  if (!lights) return failAgain(lights.error());
  options.lights = std::move(*lights);
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
  if (options.fade > 0.0f && options.fade_lights.empty())
    return fail("--fade", "there is nothing to fade to", "give lights with --fade-to");
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

Result<void> understand(const Words& words, Options& options) {
  for (const std::string& word : words.bundles) {
    const Result<std::vector<std::filesystem::path>> found = bundlesIn(word);
    if (!found) return failAgain(found.error());
    options.bundles.insert(options.bundles.end(), found->begin(), found->end());
  }
  return understandLights(words, options);
}

}  // namespace

void printError(const Error& error) {
  fmt::print(stderr, "lambent-demo: {}\n", error.line());
}

std::variant<Options, int> parseOptions(int argc, const char* const* argv) {
  CLI::App app("Shows baked scenes under light that changes: in a window, or as a picture with --headless.",
               "lambent-demo");
  Options options;
  Words words;
  declare(app, options, words);
  describe(app);
  if (const auto ended = command_line::parse(app, argc, argv)) return *ended;
  if (const Result<void> understood = understand(words, options); !understood) {
    printError(understood.error());
    return 2;
  }
  return options;
}

}  // namespace lambent::demo
