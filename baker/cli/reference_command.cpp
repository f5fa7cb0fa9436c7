// Implements lambent reference SCENE --light LIGHT... --camera CAM -o OUT.exr.
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.hpp"
#include "baker/import/gltf.hpp"
#include "baker/plan/counted.hpp"
#include "reference/reference.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::baker {

namespace {

struct ReferenceArguments {
  std::filesystem::path scene, output, png;
  std::vector<std::string> lights;
  std::string light_layout;
  std::optional<spec::Camera> camera;
  std::optional<float> time_s;  // of the file's animations; nothing: the scene at rest
  reference::Options options;
  bool json = false, force = false, allow_outside = false;
  SayOptions say;
};

// Parses the words that mean something only together, and checks the options.
Result<reference::Request> understand(const ReferenceArguments& a) {
  std::vector<std::string> words = a.lights;
  if (words.empty()) words.assign(spec::kDefaultLights.begin(), spec::kDefaultLights.end());
  auto lights = spec::parseLights(words, a.light_layout);
  if (!lights) return failAgain(lights.error());
  if (auto checked = reference::checkOptions(a.options); !checked)
    return failAgain(std::move(checked.error()));
  return reference::Request{.lights = std::move(*lights), .camera = a.camera, .options = a.options};
}

Result<float> parseTime(const std::string& word) {
  const std::optional<float> time = spec::parseNumber(word);
  if (time && *time >= 0.0f) return *time;
  return fail("--time", fmt::format("\"{}\" is not a time", word), "give seconds of 0 or more, as 1.5");
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
  auto request = understand(a);
  if (!request) return wrongUsage(request.error());
  if (!a.png.empty())  // what cannot be written is said before paths are traced
    if (const auto writable = AtomicFile::open(a.png); !writable) return reportError(writable.error());
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  Progress progress;
  progress.begin("import");
  auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return reportError(scene.error());
  if (a.time_s) {
    request->nodes_at_rest = scene->nodes;
    reference::poseAt(*scene, *a.time_s);
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
  using command_line::addValue, command_line::addWord, command_line::addWords, command_line::into;
  auto a = std::make_shared<ReferenceArguments>();
  CLI::App* command = app.add_subcommand("reference", "Path-trace a picture to measure the runtime against");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb")->required();
  reference::Options& options = a->options;
  addValue(*command, "-o,--output", a->output, "EXR", "The picture to write, linear OUT.exr")->required();
  addValue(*command, "--png", a->png, "PNG",
           "Write it for a screen, too: as lambent-demo shows light at --exposure 0");
  addWords(*command, "--light", a->lights, "LIGHT",
           "Several add up: an environment map file (.hdr, .exr), constant:R,G,B, sun:AZ,EL,ANGLE,R[,G,B] "
           "(degrees, angular radius, radiance), sphere:X,Y,Z,RADIUS,R[,G,B] or "
           "disc:X,Y,Z,NX,NY,NZ,RADIUS,R[,G,B] (metres, radiance; unseen by the camera)");
  addValue(*command, "--light-layout", a->light_layout, "LAYOUT",
           "Layout of environment maps whose shape misleads: lat-long, angular-map or vertical-cross");
  addWord(*command, "--rotate-light", "DEG", "Turn all light from infinity about +Y (+Z towards +X)",
          into(options.rotate_light_deg, spec::parseDegrees))
      ->default_str("0");
  addWord(*command, "--time", "SECONDS",
          "Play the file's animations to this second (default: the scene at rest)",
          into(a->time_s, parseTime));
  addWord(*command, "--camera", "CAM",
          "Name or index of a camera in the file, or orbit:AZ,EL,DIST,FOV (default: the file's first, else "
          "an orbit)",
          into(a->camera, spec::parseCamera));
  addWord(*command, "--size", "WxH", "Picture in pixels", into(options.size, spec::parseSize))
      ->default_str("1280x720");
  addValue(*command, "--spp", options.spp, "N", "Samples a pixel")->capture_default_str();
  addValue(*command, "--seed", options.seed, "S", "Of the random numbers; two seeds have independent noise")
      ->capture_default_str();
  addWord(*command, "--band-limit", "IN[,OUT]",
          "IN: light cut to its first IN bands (1..8), spheres and discs as seen from each point. IN,OUT: "
          "and the BRDF or phase function at the first hit to OUT bands",
          into(options.band_limit, reference::parseBandLimit));
  addValue(*command, "--bounces", options.bounces, "N",
           "Interreflections between surfaces. 0 is direct light, and single scattering in volumes; else "
           "volumes scatter as often as they do. Default: as many as matter");
  addValue(*command, "--threads", options.threads, "N",
           "Threads; default all. The result does not depend on it");
  command_line::addBytes(*command, "--max-memory", options.memory_bytes,
                         "The memory that the picture may take, in bytes or like 4GB; what needs more is "
                         "refused. Default: what the machine has");
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
