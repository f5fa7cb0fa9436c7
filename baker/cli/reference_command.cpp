// Implements lambent reference SCENE --light LIGHT... --camera CAM -o OUT.exr.
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/import/gltf.hpp"
#include "baker/plan/counted.hpp"
#include "reference/reference.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/spec/display.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::baker {

namespace {

struct ReferenceArguments {
  std::filesystem::path scene, output, png;
  std::vector<std::string> lights;
  std::string light_layout, camera, size = "1280x720", band_limit, rotate_light = "0", time;
  reference::Options options;
  bool json = false, force = false, allow_outside = false;
  SayOptions say;
};

Result<void> understandLights(const ReferenceArguments& a, reference::Request& request) {
  std::vector<std::string> words = a.lights;
  if (words.empty()) words.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  auto lights = spec::parseLights(words, a.light_layout);
  if (!lights) return failAgain(lights.error());
  request.lights = std::move(*lights);
  return {};
}

// Parses the words of the command line into values.
Result<reference::Request> understand(const ReferenceArguments& a) {
  reference::Request request{.lights = {}, .camera = {}, .options = a.options};
  if (auto done = understandLights(a, request); !done) return failAgain(std::move(done.error()));
  if (!a.camera.empty()) {
    auto camera = spec::parseCamera(a.camera);
    if (!camera) return failAgain(camera.error());
    request.camera = *camera;
  }
  const auto size = spec::parseSize(a.size);
  if (!size) return failAgain(size.error());
  request.options.size = *size;
  const auto turn = spec::parseDegrees(a.rotate_light);
  if (!turn) return failAgain(turn.error());
  request.options.rotate_light_deg = *turn;
  if (!a.band_limit.empty()) {
    const auto limit = reference::parseBandLimit(a.band_limit);
    if (!limit) return failAgain(limit.error());
    request.options.band_limit = *limit;
  }
  if (auto checked = reference::checkOptions(request.options); !checked)
    return failAgain(std::move(checked.error()));
  return request;
}

// Returns nothing for a scene at rest.
Result<std::optional<float>> understandTime(const std::string& word) {
  if (word.empty()) return std::optional<float>{};
  const std::optional<float> time = spec::parseNumber(word);
  if (!time || *time < 0.0f)
    return fail("--time", fmt::format("\"{}\" is not a time", word), "give seconds of 0 or more, as 1.5");
  return time;
}

// Expects the paths of a usual scene; the stage's own rate replaces that as soon as there is one.
PartSeconds expectedSeconds(const reference::Options& options) {
  constexpr double kGuessedPathsPerSecond = 3e5;
  const double paths = double(options.size.width) * double(options.size.height) * double(options.spp);
  return {{{"paths", paths / kGuessedPathsPerSecond}}};
}

void printReference(const ReferenceArguments& a, const reference::Request& request,
                    const reference::Report& r) {
  const double rate = r.seconds > 0.0 ? static_cast<double>(r.rays) / r.seconds : 0.0;
  if (a.json) {
    nlohmann::json json = {{"output", a.output.string()},
                           {"width", request.options.size.width},
                           {"height", request.options.size.height},
                           {"spp", request.options.spp},
                           {"seed", request.options.seed},
                           {"resumedSpp", r.resumed_samples},
                           {"rays", r.rays},
                           {"seconds", r.seconds},
                           {"raysPerSecond", rate},
                           {"peakBytes", peakBytes()},
                           {"standardError", nullptr}};
    if (r.standard_error) json["standardError"] = *r.standard_error;
    fmt::print("{}\n", json.dump(2));
    return;
  }
  if (a.say.quiet) return;
  fmt::print("{}: {} x {}, {} samples a pixel in {}\n", a.output.string(), request.options.size.width,
             request.options.size.height, request.options.spp, durationText(r.seconds));
  fmt::print("  rays   {} ({} a second)\n", countText(static_cast<double>(r.rays)), countText(rate));
  if (r.standard_error)
    fmt::print("  noise  {} standard error of a pixel\n", percentText(*r.standard_error, 3));
}

int runReference(const ReferenceArguments& a) {
  constexpr int kWrongUsage = 2;
  auto request = understand(a);
  if (!request) {
    reportError(request.error());
    return kWrongUsage;
  }
  const auto time = understandTime(a.time);
  if (!time) {
    reportError(time.error());
    return kWrongUsage;
  }
  if (!a.png.empty())  // what cannot be written is said before paths are traced
    if (const auto writable = AtomicFile::open(a.png); !writable) return reportError(writable.error());
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  Progress progress;
  progress.begin("import");
  auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return reportError(scene.error());
  if (*time) {
    request->nodes_at_rest = scene->nodes;
    reference::poseAt(*scene, **time);
  }
  for (const std::string& warning : scene->warnings) reportNotice(a.scene, warning);
  const auto report = [&] {
    const ProgressLine line(progress, WholeProgress(expectedSeconds(request->options)), a.say, a.scene);
    return reference::render(*scene, *request, a.output, a.force, progress, stop.get_token());
  }();
  if (!report) return reportError(report.error());
  for (const std::string& notice : report->notices) reportNotice({}, notice);
  if (!a.png.empty())
    if (const auto written = spec::writePng(a.png, spec::displayed(report->image)); !written)
      return reportError(written.error());
  printReference(a, *request, *report);
  return 0;
}

}  // namespace

void addReferenceCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<ReferenceArguments>();
  CLI::App* command = app.add_subcommand("reference", "Path-trace a picture to measure the runtime against");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb")->required();
  command->add_option("-o,--output", a->output, "The picture to write, linear OUT.exr")
      ->required()
      ->type_name("EXR");
  command
      ->add_option("--png", a->png,
                   "Write it for a screen, too: as lambent-demo shows light at\n--exposure 0")
      ->type_name("PNG");
  command
      ->add_option(
          "--light", a->lights,
          "Several add up: an environment map file (.hdr, .exr), constant:R,G,B,\nsun:AZ,EL,ANGLE,R[,G,B] "
          "(degrees, angular radius, radiance),\nsphere:X,Y,Z,RADIUS,R[,G,B] or "
          "disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B]\n(metres, radiance; unseen by the camera)")
      ->type_name("LIGHT")
      ->take_all()
      ->expected(1);
  command
      ->add_option(
          "--light-layout", a->light_layout,
          "Layout of environment maps whose shape misleads: lat-long, angular-map\nor vertical-cross")
      ->type_name("LAYOUT");
  command
      ->add_option("--rotate-light", a->rotate_light, "Turn all light from infinity about +Y (+Z towards +X)")
      ->capture_default_str()
      ->type_name("DEG");
  command
      ->add_option("--time", a->time,
                   "Play the file's animations to this second (default: the scene at rest)")
      ->type_name("SECONDS");
  command
      ->add_option("--camera", a->camera,
                   "Name or index of a camera in the file, or orbit:AZ,EL,DIST,FOV\n(default: the file's "
                   "first, else an orbit)")
      ->type_name("CAM");
  command->add_option("--size", a->size, "Picture in pixels")->capture_default_str()->type_name("WxH");
  command->add_option("--spp", a->options.spp, "Samples a pixel")->capture_default_str()->type_name("N");
  command->add_option("--seed", a->options.seed, "Of the random numbers; two seeds have independent noise")
      ->capture_default_str()
      ->type_name("S");
  command
      ->add_option("--band-limit", a->band_limit,
                   "IN: light cut to its first IN bands (1..8), spheres and discs\nas seen from each point. "
                   "IN,OUT: and the BRDF or phase\nfunction at the first hit to OUT bands")
      ->type_name("IN[,OUT]");
  command
      ->add_option("--bounces", a->options.bounces,
                   "Interreflections between surfaces. 0 is direct light, and single\nscattering in volumes; "
                   "else volumes scatter as often as they do.\nDefault: as many as matter")
      ->type_name("N");
  command
      ->add_option("--threads", a->options.threads, "Threads; default all. The result does not depend on it")
      ->type_name("N");
  command
      ->add_option("--max-memory", a->options.memory_bytes,
                   "The memory that the picture may take, in bytes or like 4GB; what needs\nmore is refused. "
                   "Default: what the machine has")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->type_name("BYTES");
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command->add_flag("--force", a->force, "Begin anew even if OUT.exr.partial could be gone on with");
  command->add_flag("--json", a->json, "Print figures as JSON");
  addQuiet(*command, a->say);
  addProgress(*command, a->say);
  command_line::group(*command, "Light", {"--light", "--light-layout", "--rotate-light"});
  command_line::group(*command, "Picture", {"--camera", "--size", "--time", "--png"});
  command_line::group(*command, "Paths", {"--spp", "--seed", "--band-limit", "--bounces"});
  command_line::group(*command, "Machine", {"--threads", "--max-memory"});
  command_line::group(*command, "Files and runs", {"--output", "--force", "--allow-outside"});
  command_line::group(*command, "Output", {"--json", "--quiet", "--progress"});
  command_line::addExamples(
      *command,
      {{"lambent reference scene.gltf -o ref.exr --light sky.hdr --camera main", "traces a picture"},
       {"lambent reference scene.gltf -o ref5.exr --light sky.hdr --band-limit 5,5",
        "traces what bakes with five bands can show at best"}});
  command->callback([a, &run] { run = [a] { return runReference(*a); }; });
}

}  // namespace lambent::baker
