// Implements lambent accuracy [SCENE] -o DIR.
#include <chrono>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "baker/bake/options.hpp"
#include "baker/cli/commands.hpp"
#include "baker/plan/counted.hpp"
#include "baker/sweep/sweep.hpp"
#include "runtime/command_line/help.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker {

namespace {

struct AccuracyArguments {
  SweepRequest request;
  BakeOptions quality{.quality = Quality::Draft};  // only its quality is asked for
  bool json = false;
  SayOptions say;
};

std::string knobNames() {
  std::vector<std::string_view> names;
  for (const Knob& knob : knobs()) names.push_back(knob.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<void> checkWords(const SweepRequest& request) {
  if (const auto lights = spec::parseLights(request.lights); !lights) return failAgain(lights.error());
  if (!request.camera.empty())
    if (const auto camera = spec::parseCamera(request.camera); !camera) return failAgain(camera.error());
  if (!request.size.empty())
    if (const auto size = spec::parseSize(request.size); !size) return failAgain(size.error());
  // Names of knobs and their values; which ones the scene calls for shows later.
  if (const auto known = settingsOf({}, request.quality, request.knobs); !known)
    return failAgain(known.error());
  return {};
}

// Prints one line that changes on a terminal, and a line for each setting elsewhere.
SweepListener progressLines(bool terminal) {
  const auto start = std::chrono::steady_clock::now();
  const auto begin = [=](std::size_t done, std::size_t all, const std::string& what) {
    if (!terminal) return;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    const double left = done == 0 ? 0.0 : spent.count() / double(done) * double(all - done);
    fmt::print(stderr, "\r\033[Klambent: {} of {}  {}{}", done + 1, all, what,
               done == 0 ? "" : fmt::format(", about {} left", durationText(left)));
    std::fflush(stderr);
  };
  const auto measured = [=](std::size_t done, std::size_t all, const Measured& m) {
    fmt::print(stderr, "{}lambent: {} of {}  {}: {} wrong, bake {}, frame {:.1f} ms, {}\n",
               terminal ? "\r\033[K" : "", done, all, m.setting.name(),
               percentText(m.picture.at("asLightIs").at("rms").get<double>(), 2),
               durationText(m.bake.at("seconds").get<double>()), m.picture.at("frameMs").get<double>(),
               bytesText(m.bake.at("bytes").get<double>()));
  };
  return {.begin = begin, .measured = measured};
}

int runAccuracy(AccuracyArguments a) {
  a.request.quality = a.quality.quality;
  if (const auto checked = checkWords(a.request); !checked) return wrongUsage(checked.error());
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  const auto results =
      runSweep(a.request, a.say.quiet ? SweepListener{} : progressLines(terminal), stop.get_token());
  if (!a.say.quiet && terminal) fmt::print(stderr, "\r\033[K");
  if (!results) return reportError(results.error());
  const auto page = writeReport(*results, a.request.output);
  if (!page) return reportError(page.error());
  for (const std::string& failure : results->failures) reportNotice(results->scene, failure);
  const nlohmann::json sweep = sweepJson(*results);
  if (a.json) {
    fmt::print("{}\n", sweep.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else if (!a.say.quiet) {
    for (const std::size_t time : {0u, 1u})  // of a bake and of a frame
      if (const nlohmann::json& cost = sweep.at("costs").at(time); !cost.at("take").is_null())
        fmt::print("{}\n", cost.at("say").get<std::string>());
    fmt::print("{}\n", page->string());
  }
  if (results->stopped)
    return reportError(
        {a.request.output.string(),
         fmt::format("stopped after {} of {} settings", results->settings.size(), results->asked),
         "run it again, and it goes on from where it was"});
  return results->failures.empty() ? 0 : 1;
}

}  // namespace

void addAccuracyCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<AccuracyArguments>();
  SweepRequest& request = a->request;
  CLI::App* command = app.add_subcommand(
      "accuracy",
      "Measure what each knob costs and how exact it makes the picture, and write a page about it");
  command->add_option("SCENE", request.scene, "The scene, .gltf or .glb; default: a sample scene");
  command_line::addValue(*command, "-o,--output", request.output, "DIR",
                         "Folder for sweep.json and index.html, which draws it. What it holds of an earlier "
                         "run is not measured again")
      ->required();
  // This is an option of its own, since it also says how thoroughly to measure.
  command_line::addWord(
      *command, "--quality", "draft|standard|high",
      "The base from which knobs are turned, the number of their values, and the size and paths of "
      "references; default draft",
      [a](const std::string& word) { return putOption(a->quality, "quality", word); });
  command_line::addWords(*command, "--knob", request.knobs, "KNOB[=VALUES]",
                         "Turn only this knob; =V1,V2 turns it to these values. Several are given one by "
                         "one. Knobs: " +
                             knobNames());
  command_line::addWords(*command, "--light", request.lights, "LIGHT",
                         "Light, as lambent reference takes it; several add up");
  command_line::addValue(*command, "--camera", request.camera, "CAM",
                         "Camera, as lambent reference takes it");
  command_line::addValue(*command, "--size", request.size, "WxH",
                         "Pictures in pixels; default by --quality, 320x180 for draft");
  command_line::addValue(*command, "--spp", request.spp, "N",
                         "Samples a pixel of each of two references; default by --quality")
      ->check(CLI::Range(2u, 1u << 20).description(""));
  command->add_flag("--allow-outside", request.allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command->add_flag("--force", request.force, "Measure all anew");
  command->add_flag("--json", a->json, "Print sweep.json");
  addQuiet(*command, a->say);
  command_line::group(*command, "What is measured",
                      {"--quality", "--knob", "--light", "--camera", "--size", "--spp"});
  command_line::group(*command, "Files and runs", {"--output", "--force", "--allow-outside"});
  command_line::group(*command, "Output", {"--json", "--quiet"});
  command_line::addExamples(
      *command, {{"lambent accuracy scene.gltf -o page", "measures all knobs and writes page/index.html"},
                 {"lambent accuracy scene.gltf -o page --knob rays=256,1024 --light sky.hdr",
                  "measures two values of one knob under this light"}});
  command->callback([a, &run] { run = [a] { return runAccuracy(*a); }; });
}

}  // namespace lambent::baker
