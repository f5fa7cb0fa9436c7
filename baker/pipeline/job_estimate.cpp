#include "baker/pipeline/job_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

namespace lambent::baker {

namespace {

// Rates of about one core, used only to have an estimate before anything is known.
constexpr double kGuessedRaysPerSecond = 3e6, kGuessedCodedPerSecond = 2e4;
// All bounces but the first are passed on between patches, and gathered in one more pass (bounces.hpp).
constexpr int kMostGathered = 2;
constexpr const char* kBetweenPatches = "bounce between patches";
constexpr double kPatchShare = 0.3;  // of a pass
// What is done once for a sample, whatever its rays, takes as long as so many rays.
constexpr double kRaysOfASample = 200.0;
constexpr double kMostProbeRays = 512.0;  // of a probe of refinement
// Refinement splits edges until there are so many times as many vertices, and probes each so many times.
constexpr double kGuessedGrowth = 2.0, kProbesOfAVertex = 3.5;

int gathered(const BakeOptions& options) {
  return options.bounces < 0 ? kMostGathered : std::min(options.bounces, kMostGathered);
}

double secondsIn(const StageSeconds& stages, const std::string& stage) {
  const auto found = stages.find(stage);
  return found == stages.end() ? 0.0 : found->second;
}

// Returns whether the stage's time is proportional to the rays of a sample.
bool goesWithRays(const std::string& stage) {
  return isBounce(stage) || stage == "direct light" || stage == "glossy shadows" || stage == "inside faces" ||
         stage == "paths" || stage == "light into volumes" || stage == "scattering" ||
         stage == "neighborhood";
}

// Returns whether the stage's time is proportional to the number of samples.
bool goesWithSamples(const std::string& stage) {
  return goesWithRays(stage) || stage.starts_with("coding");
}

// Returns whether the stage's own rate says how long it will take.
bool hasRate(const Progress::Stage& now, double took) {
  return now.total > 0 && now.done > 0 && took > 0.2;
}

// Returns the seconds that the rest of the stage takes at its rate so far.
double restAtRate(const Progress::Stage& now, double took) {
  return took * static_cast<double>(now.total - std::min(now.done, now.total)) /
         static_cast<double>(now.done);
}

double cells(const glm::uvec3& grid) {
  return std::max(1.0, double(grid.x) * double(grid.y) * double(grid.z));
}

// Returns how much longer a stage takes with other options; these are rough rules that the stage names
// explain.
double growth(const std::string& stage, const BakeOptions& of, const BakeOptions& to) {
  const auto before = static_cast<double>(of.effectiveRays()),
             after = static_cast<double>(to.effectiveRays());
  const double rays = (after + kRaysOfASample) / (before + kRaysOfASample);
  const double voxels = cells(to.volume_grid) / cells(of.volume_grid);
  if (stage == "scattering" || stage == "scattered light")
    return voxels * (stage == "scattering" ? rays : voxels);
  if (stage == "light into volumes") return rays * voxels;
  if (stage == kBetweenPatches) return std::sqrt(rays);
  if (goesWithRays(stage)) return rays;
  if (stage == "refinement") {  // has few rays, of which there is a limit
    const auto limited = [](double of_bake) { return std::min(of_bake, kMostProbeRays) + kRaysOfASample; };
    return limited(after) / limited(before);
  }
  if (stage == "error of pictures") {  // the rays of samples, and many
    const auto both = [](double n) { return n + std::max(2.0 * n, std::clamp(8.0 * n, 1024.0, 4096.0)); };
    return both(after) / both(before);
  }
  if (stage.starts_with("coding"))
    return std::sqrt(double{of.effectiveErrorBound()} / double{to.effectiveErrorBound()});
  return 1.0;
}

}  // namespace

bool isBounce(std::string_view stage) {
  return stage.starts_with("bounce ");
}

StageSeconds guessSeconds(const Scene& scene, const BakeOptions& options) {
  double vertices = 0.0;
  for (const gltf::Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    for (const ScenePrimitive& primitive : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives)
      vertices += static_cast<double>(primitive.mesh.positions.size());
  }
  const double rays = static_cast<double>(options.effectiveRays()) + kRaysOfASample;
  StageSeconds seconds;
  if (options.effectiveRefineBound() > 0.0f) {
    const double of_probe = std::min(static_cast<double>(options.effectiveRays()), kMostProbeRays);
    vertices *= kGuessedGrowth;
    seconds["refinement"] = vertices * kProbesOfAVertex * (of_probe + kRaysOfASample) / kGuessedRaysPerSecond;
  }
  const double direct = vertices * rays / kGuessedRaysPerSecond;
  seconds["direct light"] = direct;
  if (options.fitsDiffuse()) seconds["inside faces"] = direct;
  seconds["coding"] = vertices / kGuessedCodedPerSecond;
  for (int bounce = 1; bounce <= gathered(options); ++bounce)
    seconds[fmt::format("bounce {}", bounce)] = 0.3 * direct;
  if (gathered(options) > 1) seconds[kBetweenPatches] = kPatchShare * 0.3 * direct;
  return seconds;
}

StageSeconds sumSeconds(std::span<const Progress::Stage> stages) {
  StageSeconds seconds;
  for (const Progress::Stage& stage : stages) seconds[stage.name] += stage.seconds;
  return seconds;
}

double sumSeconds(const StageSeconds& stages) {
  double sum = 0.0;
  for (const auto& [stage, seconds] : stages) sum += seconds;
  return sum;
}

StageSeconds scaleSeconds(std::span<const Progress::Stage> stages, const BakeOptions& of,
                          const BakeOptions& to) {
  StageSeconds seconds;
  for (const Progress::Stage& stage : stages)
    seconds[stage.name] += stage.seconds * growth(stage.name, of, to);
  // Passes beyond those measured cost about as much as the last one.
  const int bounces = gathered(to);
  if (const auto first = seconds.find("bounce 1"); bounces > 1 && first != seconds.end())
    seconds.try_emplace(kBetweenPatches, kPatchShare * first->second);
  for (int bounce = 2; bounce <= bounces; ++bounce)
    for (const char* where : {"", " inside faces"}) {
      const auto before = seconds.find(fmt::format("bounce {}{}", bounce - 1, where));
      if (before != seconds.end())
        seconds.try_emplace(fmt::format("bounce {}{}", bounce, where), before->second);
    }
  // There are twice as many triangles as vertices, and rays may start from most of them.
  const auto shadows = seconds.find("glossy shadows");
  if (shadows == seconds.end() || !to.fitsGlossy() || of.fitsGlossy()) return seconds;
  seconds.try_emplace("inside faces", 2.0 * shadows->second);
  for (int bounce = 1; bounce <= bounces; ++bounce) {
    const auto found = seconds.find(fmt::format("bounce {}", bounce));
    if (found != seconds.end())
      seconds.try_emplace(fmt::format("bounce {} inside faces", bounce), 2.0 * found->second);
  }
  return seconds;
}

double secondsOf(const Progress::Stage& now, const StageSeconds& before,
                 std::span<const Progress::Stage> finished) {
  // A bake of several groups has a stage more than once; what was spent before is taken for that of the
  // first.
  const bool first = std::ranges::find(finished, now.name, &Progress::Stage::name) == finished.end();
  return now.seconds + (first ? secondsIn(before, now.name) : 0.0);
}

double secondsLeft(const StageSeconds& expected, const StageSeconds& before,
                   std::span<const Progress::Stage> finished, const Progress::Stage& now) {
  const StageSeconds spent = sumSeconds(finished);
  const auto spentOn = [&](const std::string& stage) {
    return secondsIn(spent, stage) + secondsIn(before, stage);
  };
  // Once another stage begins after bounces, no further bounce will come.
  bool past_bounces = !isBounce(now.name);
  if (past_bounces)
    past_bounces = std::any_of(finished.begin(), finished.end(),
                               [](const Progress::Stage& stage) { return isBounce(stage.name); });
  const double took = secondsOf(now, before, finished);
  const double own = hasRate(now, took) ? restAtRate(now, took) : 0.0;
  // Stages that take longer than expected have more samples or a slower machine, and so have later ones. That
  // they take less says nothing, since other groups may follow.
  double known = 0.0, known_expected = 0.0;
  for (const auto& [stage, seconds] : expected) {
    if (!goesWithSamples(stage)) continue;
    if (stage == now.name && !hasRate(now, took)) continue;
    const double known_of = spentOn(stage) + (stage == now.name ? now.seconds + own : 0.0);
    if (known_of > 0.0) known += known_of, known_expected += seconds;
  }
  const double slower = known_expected > 0.0 ? std::max(1.0, known / known_expected) : 1.0;
  double left = 0.0;
  for (const auto& [stage, seconds] : expected) {
    if (stage == now.name || (isBounce(stage) && past_bounces)) continue;
    const double of_stage = goesWithSamples(stage) && spentOn(stage) == 0.0 ? slower * seconds : seconds;
    left += std::max(0.0, of_stage - spentOn(stage));
  }
  const double this_one = std::max(0.0, secondsIn(expected, now.name) - spentOn(now.name));
  // The stage's own rate is used once it is meaningful, plus what is expected for later groups.
  if (hasRate(now, took)) return left + own + std::max(0.0, this_one - now.seconds - own);
  return left + std::max(0.0, this_one - now.seconds);
}

void writeSeconds(const StageSeconds& stages, ByteWriter& out) {
  out.add(std::uint64_t{stages.size()});
  for (const auto& [stage, seconds] : stages) {
    out.addList(std::vector<char>(stage.begin(), stage.end()));
    out.add(seconds);
  }
}

bool readSeconds(ByteReader& in, StageSeconds& stages) {
  std::uint64_t count = 0;
  if (!in.read(count)) return false;
  std::vector<char> stage;
  for (std::uint64_t i = 0; i < count; ++i)
    if (!in.readList(stage) || !in.read(stages[std::string(stage.begin(), stage.end())])) return false;
  return true;
}

}  // namespace lambent::baker
