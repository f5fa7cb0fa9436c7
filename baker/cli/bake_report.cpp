#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

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

double secondsOf(const BakeReport& report) {
  double seconds = 0.0;
  for (const Progress::Stage& stage : report.stages) seconds += stage.seconds;
  return seconds;
}

// Returns the group whose pictures are furthest off for their bound; null if none was measured.
const BakeReport::Group* worstGroup(const BakeReport& report) {
  const BakeReport::Group* worst = nullptr;
  for (const BakeReport::Group& group : report.groups)
    if (group.picture_error && (!worst || group.picture_error->all > worst->picture_error->all))
      worst = &group;
  return worst;
}

// Returns what would make pictures better, by the largest part of their error.
std::string helpFor(const FinishedBake& bake, const bundle::PictureError& error) {
  const bool finer = bake.options.quality != Quality::High;
  if (error.interpolation >= std::max(error.samples, error.codes))
    return finer ? "--quality high splits more edges where light changes"
                 : "a finer mesh, or --max-edge, where light changes helps";
  if (error.codes > error.samples) return "a lower --codes keeps more of the transfer";
  return fmt::format("--rays {} takes most of it away", 4 * bake.options.effectiveRays());
}

// Says which bounds and limits are missed; empty if all are kept.
std::string missedText(const FinishedBake& bake) {
  std::vector<std::string> missed;
  if (const BakeReport::Group* group = worstGroup(bake.report);
      group && bundle::missesBound(group->picture_error->all, group->picture_error->bound))
    missed.push_back(fmt::format("pictures of \"{}\" are {} wrong instead of {}; {}", group->name,
                                 percentText(double{group->picture_error->all}),
                                 percentText(double{group->picture_error->bound}),
                                 helpFor(bake, *group->picture_error)));
  if (const double bound = double{bake.options.error_bound}; bound > 0.0) {
    const double error = std::max(bake.report.worst_error, bake.report.worst_glossy_error);
    if (bundle::missesBound(error, bound))
      missed.push_back(
          fmt::format("--codes: {} instead of {}", percentText(error, 2), percentText(bound, 2)));
  }
  // Past a tenth, the limit was not kept: the rest is what the bake cannot do without.
  constexpr double kKept = 1.1;
  if (const double limit = static_cast<double>(bake.options.memory_bytes),
      took = static_cast<double>(peakBytes());
      limit > 0.0 && took > kKept * limit)
    missed.push_back(
        fmt::format("--max-memory: {} instead of {}, which this bake takes even if it keeps no hits",
                    bytesText(took), bytesText(limit)));
  return fmt::format("{}", fmt::join(missed, "; "));
}

}  // namespace

std::string pictureErrorText(const bundle::PictureError& error) {
  return fmt::format(
      "{} wrong (bound {}) where eyes look: {} by too few rays, {} by codes, {} between vertices",
      percentText(double{error.all}), percentText(double{error.bound}), percentText(double{error.samples}),
      percentText(double{error.codes}), percentText(double{error.interpolation}));
}

nlohmann::json pictureErrorJson(const std::optional<bundle::PictureError>& error) {
  if (!error) return nullptr;
  return {{"all", error->all},
          {"samples", error->samples},
          {"codes", error->codes},
          {"interpolation", error->interpolation},
          {"points", error->points},
          {"bound", error->bound > 0.0f ? nlohmann::json(error->bound) : nlohmann::json()}};
}

nlohmann::json reportJson(const FinishedBake& bake) {
  const BakeReport& r = bake.report;
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
                      {"effects", effects},
                      {"pictureError", pictureErrorJson(group.picture_error)},
                      {"codesBound", group.codes_bound},
                      {"glossyCodesBound", group.glossy_codes_bound}});
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
  return {{"output", bake.output.string()},
          {"settings", bake.options.settings()},
          {"vertices", r.vertices},
          {"triangles", r.triangles},
          {"samples", r.samples},
          {"filledSamples", r.filled_samples},
          {"texelSamples", r.texel_samples},
          {"rays", r.rays},
          {"raysKept", r.rays_kept},
          {"raysPerSecond", r.ray_seconds > 0.0 ? static_cast<double>(r.rays) / r.ray_seconds : 0.0},
          {"peakBytes", peakBytes()},
          {"lights", r.lights},
          {"groups", groups},
          {"neighborhoods", neighborhoods},
          {"volumes", volumes},
          {"passEnergy", r.pass_energy},
          {"leftOut", r.left_out},
          {"hitBytes", r.hit_bytes},
          {"codingError", r.worst_error},
          {"glossyCodingError", r.worst_glossy_error},
          {"missesBound", missesBound(bake)},
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

bool missesBound(const FinishedBake& bake) {
  return !missedText(bake).empty();
}

void printReport(const FinishedBake& bake) {
  const BakeReport& r = bake.report;
  fmt::print("{}: {} vertices, {} triangles, {} samples in {}\n", bake.output.string(), r.vertices,
             r.triangles, r.samples, durationText(secondsOf(r)));
  if (r.texel_samples > 0) fmt::print("  texels    {} of the samples\n", r.texel_samples);
  if (const RefineReport& refined = r.refinement; refined.vertices_after > refined.vertices_before)
    fmt::print("  refined   {} vertices to {}\n", refined.vertices_before, refined.vertices_after);
  if (const BakeReport::Group* group = worstGroup(r))
    fmt::print("  pictures  {}{}\n", r.groups.size() > 1 ? fmt::format("\"{}\": ", group->name) : "",
               pictureErrorText(*group->picture_error));
  fmt::print("  time      {}\n", stagesText(r.stages));
  fmt::print("  rays      {} in {} ({} a second)\n", countText(static_cast<double>(r.rays)),
             durationText(r.ray_seconds),
             countText(r.ray_seconds > 0.0 ? static_cast<double>(r.rays) / r.ray_seconds : 0.0));
  if (r.rays_kept > 0)
    fmt::print("  kept      {} rays of earlier bakes; {} read from the cache\n",
               countText(static_cast<double>(r.rays_kept)),
               bytesText(static_cast<double>(r.cache.bytes_read)));
  if (!r.pass_energy.empty()) fmt::print("  bounces   {}\n", r.pass_energy.size() - 1);
  for (const BakeReport::Volume& volume : r.volumes)
    fmt::print(
        "  volume    {}: {} voxels, {} samples, density in {} bits ({}), scattering solved in {} steps\n",
        volume.name, volume.voxels, volume.samples, volume.density_bits, percentText(volume.density_error, 2),
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
  for (const BakeReport::Neighborhood& n : r.neighborhoods)
    fmt::print("  around    {}: {} x {} x {} points, {} of irradiance, {} of the change\n", n.name, n.size.x,
               n.size.y, n.size.z, percentText(n.error, 3), percentText(n.change_error));
  if (const std::string missed = missedText(bake); !missed.empty()) fmt::print("  missed    {}\n", missed);
}

}  // namespace lambent::baker
