// Implements lambent bake SCENE -o OUT.lmb.glb, --watch DIR, --resume.
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/cli/watch.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/journal.hpp"
#include "baker/plan/counted.hpp"

namespace lambent::baker {

namespace {

struct BakeArguments {
  std::filesystem::path scene, output;
  std::filesystem::path watch;  // a folder; empty means none
  bool resume = false;
  double checkpoint_s = 0.0;  // 0 keeps the cache's own interval
  BakeOptions options;
  bool force = false, json = false, allow_outside = false;
  std::string cache;  // a folder, "off", or empty for the default one
  std::uint64_t cache_bytes = kCacheBytes;
};

// A bake without a cache is only slower, so a problem with its folder is reported and no error.
std::optional<Cache> openCache(const BakeArguments& a) {
  if (a.cache == "off") return std::nullopt;
  const std::filesystem::path folder =
      a.cache.empty() ? Cache::defaultFolder() : std::filesystem::path(a.cache);
  if (folder.empty()) return std::nullopt;
  auto cache = Cache::open(folder, a.cache_bytes);
  if (!cache) {
    fmt::print(stderr, "lambent: {}; baking without it\n", cache.error().line());
    return std::nullopt;
  }
  cache->setReading(!a.force);
  if (a.checkpoint_s > 0.0) cache->setCheckpointEvery(a.checkpoint_s);
  return std::move(*cache);
}

nlohmann::json reportJson(const BakeArguments& a, const BakeReport& r) {
  nlohmann::json stages = nlohmann::json::array();
  for (const Progress::Stage& stage : r.stages)
    stages.push_back(
        {{"stage", stage.name}, {"seconds", stage.seconds}, {"units", stage.done}, {"unit", stage.unit}});
  nlohmann::json groups = nlohmann::json::array();
  for (const BakeReport::Group& group : r.groups) {
    nlohmann::json effects = nlohmann::json::array();
    for (const BakeReport::Group::Effect& effect : group.effects)
      effects.push_back({{"effect", effect.name},
                         {"work", reuseName(effect.reuse)},
                         {"rays", effect.rays},
                         {"raysKept", effect.rays_kept}});
    groups.push_back({{"name", group.name},
                      {"lightSamples", group.light_probes},
                      {"proxyTriangles", group.proxy_triangles},
                      {"effects", effects}});
  }
  nlohmann::json neighborhoods = nlohmann::json::array();
  for (const BakeReport::Neighborhood& n : r.neighborhoods)
    neighborhoods.push_back({{"name", n.name},
                             {"size", {n.size.x, n.size.y, n.size.z}},
                             {"boundsMin", {n.bounds_min.x, n.bounds_min.y, n.bounds_min.z}},
                             {"boundsMax", {n.bounds_max.x, n.bounds_max.y, n.bounds_max.z}},
                             {"insidePoints", n.inside_points},
                             {"codingError", n.error},
                             {"changeCodingError", n.change_error}});
  nlohmann::json volumes = nlohmann::json::array();
  for (const BakeReport::Volume& volume : r.volumes)
    volumes.push_back({{"name", volume.name},
                       {"voxels", volume.voxels},
                       {"samples", volume.samples},
                       {"densityBits", volume.density_bits},
                       {"densityError", volume.density_error},
                       {"iterations", volume.iterations},
                       {"residual", volume.residual},
                       {"rowBytes", volume.row_bytes}});
  return {{"output", a.output.string()},
          {"settings", a.options.settings()},
          {"vertices", r.vertices},
          {"triangles", r.triangles},
          {"samples", r.samples},
          {"filledSamples", r.filled_samples},
          {"rays", r.rays},
          {"raysKept", r.rays_kept},
          {"raysPerSecond", r.ray_seconds > 0.0 ? static_cast<double>(r.rays) / r.ray_seconds : 0.0},
          {"lights", r.lights},
          {"groups", groups},
          {"neighborhoods", neighborhoods},
          {"volumes", volumes},
          {"passEnergy", r.pass_energy},
          {"leftOut", r.left_out},
          {"hitBytes", r.hit_bytes},
          {"codingError", r.worst_error},
          {"glossyCodingError", r.worst_glossy_error},
          {"glossySamples", r.glossy_samples},
          {"fileBytes", r.file_bytes},
          {"meshBytes", r.mesh_bytes},
          {"transferBytes", r.transfer_bytes},
          {"proxyBytes", r.proxy_bytes},
          {"imageBytes", r.image_bytes},
          {"notices", r.notices},
          {"refinement",
           {{"verticesBefore", r.refinement.vertices_before},
            {"verticesAfter", r.refinement.vertices_after},
            {"fans", r.refinement.fans},
            {"errorBefore", r.refinement.error_before},
            {"errorAfter", r.refinement.error_after},
            {"rays", r.refinement.rays},
            {"raysKept", r.refinement.rays_kept}}},
          {"cache",
           {{"found", r.cache.found},
            {"bytesRead", r.cache.bytes_read},
            {"stored", r.cache.stored},
            {"bytesWritten", r.cache.bytes_written},
            {"damaged", r.cache.damaged},
            {"evicted", r.cache.evicted}}},
          {"stages", stages}};
}

// Returns where the time went, the longest first, as "bounces 9.1 s, refinement 3.6 s".
std::string stagesText(const std::vector<Progress::Stage>& stages) {
  constexpr std::size_t kMostShown = 6;
  std::vector<std::pair<std::string, double>> sums;
  for (const Progress::Stage& stage : stages) {
    // Passes of bounces are one stage to whoever waits.
    const std::string name = stage.name.starts_with("bounce ") ? "bounces" : stage.name;
    const auto known = std::ranges::find(sums, name, &std::pair<std::string, double>::first);
    if (known != sums.end())
      known->second += stage.seconds;
    else
      sums.emplace_back(name, stage.seconds);
  }
  std::ranges::stable_sort(sums, std::ranges::greater(), &std::pair<std::string, double>::second);
  std::string text;
  for (std::size_t i = 0; i < std::min(sums.size(), kMostShown); ++i)
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", sums[i].first, durationText(sums[i].second));
  return text;
}

void printReport(const BakeArguments& a, const BakeReport& r) {
  double seconds = 0.0;
  for (const Progress::Stage& stage : r.stages) seconds += stage.seconds;
  fmt::print("{}: {} vertices, {} triangles, {} samples in {}\n", a.output.string(), r.vertices, r.triangles,
             r.samples, durationText(seconds));
  if (const RefineReport& refined = r.refinement; refined.vertices_after > refined.vertices_before)
    fmt::print("  refined   {} vertices to {}: shadows between them {:.2f} % wrong, before {:.2f} %{}\n",
               refined.vertices_before, refined.vertices_after, 100.0 * refined.error_after,
               100.0 * refined.error_before,
               refined.fans > 0 ? fmt::format("; {} more values where faces disagree", refined.fans) : "");
  fmt::print("  time      {}\n", stagesText(r.stages));
  fmt::print("  rays      {} in {} ({} a second)\n", countText(static_cast<double>(r.rays)),
             durationText(r.ray_seconds),
             countText(r.ray_seconds > 0.0 ? static_cast<double>(r.rays) / r.ray_seconds : 0.0));
  if (r.rays_kept > 0)
    fmt::print("  kept      {} rays of earlier bakes; {} read from the cache\n",
               countText(static_cast<double>(r.rays_kept)),
               bytesText(static_cast<double>(r.cache.bytes_read)));
  if (!r.pass_energy.empty())
    fmt::print("  bounces   {}, the last with {:.3f} % of the direct light; {:.3f} % left out\n",
               r.pass_energy.size() - 1, 100.0 * r.pass_energy.back(), 100.0 * r.left_out);
  for (const BakeReport::Volume& volume : r.volumes)
    fmt::print(
        "  volume    {}: {} voxels, {} samples, density in {} bits ({:.2f} %), scattering solved in {} "
        "steps\n",
        volume.name, volume.voxels, volume.samples, volume.density_bits, 100.0 * volume.density_error,
        volume.iterations);
  std::uint64_t light_probes = 0, proxy_triangles = 0;
  for (const BakeReport::Group& group : r.groups)
    light_probes += group.light_probes,
        proxy_triangles += group.proxy_triangles.empty() ? 0 : group.proxy_triangles.front();
  fmt::print("  groups    {}: {}, {} proxy triangles\n", r.groups.size(),
             counted(light_probes, "light probe"), proxy_triangles);
  fmt::print(
      "  bytes     {}: mesh {}, transfer {} ({:.1f} a vertex), proxies {}, images {}\n",
      bytesText(static_cast<double>(r.file_bytes)), bytesText(static_cast<double>(r.mesh_bytes)),
      bytesText(static_cast<double>(r.transfer_bytes)),
      static_cast<double>(r.transfer_bytes) / static_cast<double>(std::max<std::uint64_t>(r.vertices, 1)),
      bytesText(static_cast<double>(r.proxy_bytes)), bytesText(static_cast<double>(r.image_bytes)));
  fmt::print("  coding    {:.2f} % relative error of shaded radiance (bound {:.2f} %)\n",
             100.0 * r.worst_error, 100.0 * double{a.options.effectiveErrorBound()});
  for (const BakeReport::Neighborhood& n : r.neighborhoods)
    fmt::print("  around    {}: {} x {} x {} points, {:.3f} % of irradiance, {:.1f} % of the change\n",
               n.name, n.size.x, n.size.y, n.size.z, 100.0 * n.error, 100.0 * n.change_error);
  if (r.worst_glossy_error > 0.0)
    fmt::print("            {:.2f} % of glossy surfaces (bound {:.2f} %){}\n", 100.0 * r.worst_glossy_error,
               100.0 * double{a.options.effectiveGlossyErrorBound()},
               r.worst_glossy_error > 2.0 * double{a.options.effectiveGlossyErrorBound()}
                   ? ": --error holds more, at a price in bytes and time"
                   : "");
}

// The journal of this program lies in the cache's folder.
Journal journalOf(const std::optional<Cache>& cache) {
  return Journal(cache ? cache->folder() / "journal" : std::filesystem::path());
}

int bakeScene(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  if (const auto checked = checkRequest(a.options, a.output); !checked) return reportError(checked.error());
  Journal::Entry record = journalOf(cache).begin({.scene = a.scene,
                                                  .output = a.output,
                                                  .options = a.options,
                                                  .import = {.allow_outside = a.allow_outside}});
  Progress progress;
  progress.begin("import");
  auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) {
    record.done();
    return reportError(scene.error());
  }
  for (const std::string& warning : scene->warnings)
    fmt::print(stderr, "lambent: {}: {}\n", a.scene.string(), warning);
  if (!a.force && isUpToDate(*scene, a.options, a.output)) {
    record.done();
    if (a.json)
      fmt::print("{}\n", nlohmann::json{{"output", a.output.string()}, {"upToDate", true}}.dump(2));
    else
      fmt::print("{} is up to date; --force bakes it again\n", a.output.string());
    return 0;
  }
  Result<BakeReport> report = [&] {
    const ProgressLine line(progress);
    return bake(*scene, a.options, a.output, {progress, stop, cache ? &*cache : nullptr});
  }();
  if (!stop.stop_requested()) record.done();  // otherwise --resume continues it
  if (!report) return reportError(report.error());
  for (const std::string& notice : report->notices)
    fmt::print(stderr, "lambent: {}: {}\n", a.scene.string(), notice);
  if (a.json)
    fmt::print("{}\n", reportJson(a, *report).dump(2));
  else
    printReport(a, *report);
  return 0;
}

// Reports an error in the command line and returns the exit code 2.
int wrongUsage(const Error& error) {
  reportError(error);
  return 2;
}

// Bakes everything that was cut short, with the options that it had.
int resumeBakes(const BakeArguments& a, std::optional<Cache>& cache, const std::stop_token& stop) {
  if (!cache) return reportError({"--resume", "there is no cache that would tell", "leave out --cache off"});
  const std::vector<BakeRequest> unfinished = journalOf(cache).unfinished();
  if (unfinished.empty()) fmt::print(stderr, "lambent: no bake was cut short\n");
  int worst = 0;
  for (const BakeRequest& request : unfinished) {
    if (stop.stop_requested()) break;
    fmt::print(stderr, "lambent: going on with {} to {}\n", request.scene.string(), request.output.string());
    BakeArguments one = a;
    one.scene = request.scene;
    one.output = request.output;
    one.options = request.options;
    one.allow_outside = request.import.allow_outside;
    worst = std::max(worst, bakeScene(one, cache, stop));
  }
  return worst;
}

int runBake(const BakeArguments& a) {
  if (!a.watch.empty()) {
    if (!a.scene.empty() || a.resume || a.force)
      return wrongUsage({"--watch", "is given with a scene, --resume or --force", "give it a folder alone"});
    if (const auto checked = checkRequest(a.options, std::filesystem::temp_directory_path() / "lambent");
        !checked)
      return reportError(checked.error());
    std::optional<Cache> cache = openCache(a);
    return watchFolder({a.watch, a.output, a.options, {.allow_outside = a.allow_outside}, a.json},
                       cache ? &*cache : nullptr);
  }
  if (a.scene.empty() && !a.resume)
    return wrongUsage({"SCENE", "is missing", "name a scene, or a folder with --watch"});
  if (a.scene.empty() != a.output.empty())
    return wrongUsage({a.scene.empty() ? "SCENE" : "--output", "is missing", "give both"});
  const std::stop_source stop;
  const InterruptGuard interrupts(stop);
  std::optional<Cache> cache = openCache(a);
  return a.scene.empty() ? resumeBakes(a, cache, stop.get_token()) : bakeScene(a, cache, stop.get_token());
}

}  // namespace

void addBakeCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<BakeArguments>();
  CLI::App* command = app.add_subcommand("bake", "Bake a glTF scene into a bundle");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb");
  command->add_option("-o,--output", a->output,
                      "The bundle to write, OUT.lmb.glb; with --watch a folder for bundles (default: beside "
                      "their scenes)");
  command
      ->add_option("--watch", a->watch,
                   "Bake all scenes in DIR and below, then again what changes, until interrupted")
      ->type_name("DIR");
  command->add_flag("--resume", a->resume,
                    "Without SCENE: finish all bakes that were cut short. With it there is no need: a bake "
                    "always goes on from what the cache holds of it");
  addBakeOptions(*command, a->options);
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command
      ->add_option(
          "--cache", a->cache,
          "Folder where results are kept, so that the next bake does only what changed; off: none; default "
          "$LAMBENT_CACHE, else $XDG_CACHE_HOME/lambent, else ~/.cache/lambent")
      ->type_name("DIR|off");
  command
      ->add_option("--cache-size", a->cache_bytes,
                   "Bytes that the cache may hold, like 8GB (default); what was not used longest goes first")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->type_name("BYTES");
  command
      ->add_option("--checkpoint", a->checkpoint_s,
                   "How many seconds of work a bake that is killed may lose, about; default 8")
      ->check(CLI::Range(0.05, 600.0))
      ->type_name("S");
  command->add_flag("--force", a->force,
                    "Bake all anew, even if the bundle is up to date and whatever the cache holds");
  command->add_flag("--json", a->json, "Print figures as JSON");
  command->callback([a, &run] { run = [a] { return runBake(*a); }; });
}

}  // namespace lambent::baker
