#include "editor/app/options.hpp"

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "runtime/command_line/help.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::editor {

namespace {

struct OptionWords {
  std::vector<std::string> files, lights;
  std::string size, script, cache, output;
  float scale = 0.0f;
  bool json = false, fresh = false, no_bake = false;
  std::uint64_t max_memory = ~std::uint64_t{0}, cache_size = std::uint64_t{8} << 30;
  unsigned threads = 0;
  std::string quality = "standard";
};

void declare(CLI::App& app, OptionWords& words) {
  app.add_option("FILE", words.files,
                 "Scenes (.gltf, .glb), bundles (.lmb.glb), folders of them,\nor a world (.json)")
      ->type_name("");
  app.add_option("--light", words.lights,
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
  app.add_option("--cache-size", words.cache_size, "What it may hold, in bytes or like 4GB")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
  app.add_option("--max-memory", words.max_memory, "GPU memory for bundles, in bytes or like 200MB")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false));
  app.add_option("--threads", words.threads, "Threads of bakes (default: all but one)")->type_name("N");
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

Result<Options> understand(const OptionWords& words) {
  Options options;
  options.session.files.assign(words.files.begin(), words.files.end());
  options.session.light_words = words.lights;
  if (const auto lights = spec::parseLights(words.lights); !lights) return failAgain(lights.error());
  if (!words.size.empty()) {
    const auto size = spec::parseSize(words.size);
    if (!size) return failAgain(size.error());
    options.width = static_cast<int>(size->width), options.height = static_cast<int>(size->height);
  }
  if (!words.script.empty()) options.script = words.script;
  options.scale = words.scale;
  options.json = words.json;
  options.remember = !words.fresh;
  options.session.quality = words.quality == "draft"  ? baker::Quality::Draft
                            : words.quality == "high" ? baker::Quality::High
                                                      : baker::Quality::Standard;
  options.session.output_folder = words.output;
  options.session.cache_folder = words.cache;
  options.session.cache_bytes = words.cache_size;
  options.session.max_memory_bytes = words.max_memory;
  options.session.threads = words.threads;
  options.session.bake = !words.no_bake;
  return options;
}

}  // namespace

void printError(const Error& error) {
  fmt::print(stderr, "lambent-editor: {}\n", error.line());
}

std::variant<Options, int> parseOptions(int argc, const char* const* argv) {
  CLI::App app("Opens, bakes and lights scenes, and shows what accuracy costs.", "lambent-editor");
  OptionWords words;
  declare(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    printError(command_line::usageError(app, error));
    return 2;
  }
  Result<Options> options = understand(words);
  if (options) return std::move(*options);
  printError(options.error());
  return 2;
}

}  // namespace lambent::editor
