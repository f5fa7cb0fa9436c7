#include "baker/pipeline/job_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

namespace lambent::baker {

namespace {

// What is done once for a sample, whatever its rays, takes as long as so many rays.
constexpr double kRaysOfASample = 200.0;
constexpr double kMostProbeRays = 512.0;  // of a probe of refinement
// Measured times count against this share of all that was expected, so that the first short stages say
// little.
constexpr double kPaceBegins = 0.05;

bool isIn(const PartSeconds& parts, std::size_t part, const std::string& stage) {
  return part < parts.size() && parts[part].contains(stage);
}

double secondsIn(const PartSeconds& parts, std::size_t part, const std::string& stage) {
  return isIn(parts, part, stage) ? parts[part].at(stage) : 0.0;
}

// Returns whether a stage of this name has ended in the same part.
bool ranBefore(const Progress::Stage& now, std::span<const Progress::Stage> finished) {
  return std::ranges::any_of(finished, [&](const Progress::Stage& stage) {
    return stage.part == now.part && stage.name == now.name;
  });
}

// Returns whether the stage's time is proportional to the rays of a sample.
bool goesWithRays(const std::string& stage) {
  static constexpr std::array kStages = {"direct light",       "glossy shadows", "inside faces", "paths",
                                         "light into volumes", "scattering",     "neighborhood"};
  return isBounce(stage) || std::ranges::find(kStages, stage) != kStages.end();
}

bool tracesRays(const std::string& stage) {
  return goesWithRays(stage) || stage == kRefinement;
}

bool isCoding(const std::string& stage) {
  return stage.starts_with("coding");
}

// Returns the seconds that the rest of the stage takes at its rate so far, once that says something.
std::optional<double> restAtRate(const Progress::Stage& now, double took) {
  constexpr double kLeast_s = 0.2, kMost_s = 2.0, kLeastShare = 0.05;
  if (now.total == 0 || now.done == 0 || took <= kLeast_s) return std::nullopt;
  // The first samples wait for what all need.
  const double share = static_cast<double>(now.done) / static_cast<double>(now.total);
  if (took <= kMost_s && share < kLeastShare) return std::nullopt;
  return took * static_cast<double>(now.total - std::min(now.done, now.total)) /
         static_cast<double>(now.done);
}

// Returns how long stages that trace rays take, times what was expected. Those that take longer have more
// samples, or a slower machine, and so have those to come; and the reverse. `own` is how much longer the
// running stage takes at its rate, if it has one.
double paceOf(const PartSeconds& expected, const PartSeconds& before,
              std::span<const Progress::Stage> finished, const Progress::Stage& now,
              std::optional<double> own) {
  PartSeconds known = partSeconds(finished), of_found;
  for (const Progress::Stage& stage : finished)
    if (stage.found) addSeconds(of_found, stage, 0.0);
  // Refinement learns only as it goes how much there is to do.
  if (own && now.name != kRefinement) addSeconds(known, now, now.seconds + *own);
  if (now.found) addSeconds(of_found, now, 0.0);
  double took = 0.0, expected_of_these = 0.0, all = 0.0;
  for (std::size_t part = 0; part < expected.size(); ++part)
    for (const auto& [stage, seconds] : expected[part]) {
      if (!tracesRays(stage)) continue;
      all += seconds;
      const double kept = secondsIn(before, part, stage);
      if (!isIn(known, part, stage) || (isIn(of_found, part, stage) && kept == 0.0)) continue;
      took += secondsIn(known, part, stage) + kept;
      expected_of_these += seconds;
    }
  const double begins = kPaceBegins * all;
  return all > 0.0 ? (took + begins) / (expected_of_these + begins) : 1.0;
}

// Codes take longer where there are more samples, but no shorter where rays do.
double paceOf(const std::string& stage, double of_rays) {
  if (tracesRays(stage)) return of_rays;
  return isCoding(stage) ? std::max(1.0, of_rays) : 1.0;
}

// Returns how much longer a stage takes with other options; these are rough rules that the stage names
// explain.
double growth(const std::string& stage, const BakeOptions& of, const BakeOptions& to) {
  const auto before = static_cast<double>(of.effectiveRays()),
             after = static_cast<double>(to.effectiveRays());
  const double rays = (after + kRaysOfASample) / (before + kRaysOfASample);
  const double voxels = cellsOf(to.volume_grid) / cellsOf(of.volume_grid);
  if (stage == "scattering" || stage == "scattered light")
    return voxels * (stage == "scattering" ? rays : voxels);
  if (stage == "light into volumes") return rays * voxels;
  if (stage == kBetweenPatches) return std::sqrt(rays);
  if (goesWithRays(stage)) return rays;
  if (stage == kRefinement) {  // has few rays, of which there is a limit
    const auto limited = [](double of_bake) { return std::min(of_bake, kMostProbeRays) + kRaysOfASample; };
    return limited(after) / limited(before);
  }
  if (stage == "error of pictures") {  // the rays of samples, and many
    const auto both = [](double n) { return n + std::max(2.0 * n, std::clamp(8.0 * n, 1024.0, 4096.0)); };
    return both(after) / both(before);
  }
  if (isCoding(stage)) return std::sqrt(double{of.effectiveErrorBound()} / double{to.effectiveErrorBound()});
  return 1.0;
}

// Estimates a part of a bake from its stages in a bake with other options.
StageSeconds scalePart(std::span<const Progress::Stage> stages, const BakeOptions& of,
                       const BakeOptions& to) {
  StageSeconds seconds;
  for (const Progress::Stage& stage : stages)
    seconds[stage.name] += stage.seconds * growth(stage.name, of, to);
  // Passes beyond those measured cost about as much as the last one.
  const int bounces = gatheredBounces(to);
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

}  // namespace

int gatheredBounces(const BakeOptions& options) {
  constexpr int kMostGathered = 2;
  return options.bounces < 0 ? kMostGathered : std::min(options.bounces, kMostGathered);
}

double cellsOf(const glm::uvec3& grid) {
  return std::max(1.0, double(grid.x) * double(grid.y) * double(grid.z));
}

bool isBounce(std::string_view stage) {
  return stage.starts_with("bounce ");
}

void addSeconds(PartSeconds& parts, const Progress::Stage& stage, double seconds) {
  if (stage.part >= parts.size()) parts.resize(stage.part + 1);
  parts[stage.part][stage.name] += seconds;
}

PartSeconds partSeconds(std::span<const Progress::Stage> stages) {
  PartSeconds parts;
  for (const Progress::Stage& stage : stages) addSeconds(parts, stage, stage.seconds);
  return parts;
}

PartSeconds scaleSeconds(std::span<const Progress::Stage> stages, const BakeOptions& of,
                         const BakeOptions& to) {
  std::vector<std::vector<Progress::Stage>> cut;
  for (const Progress::Stage& stage : stages) {
    if (stage.part >= cut.size()) cut.resize(stage.part + 1);
    cut[stage.part].push_back(stage);
  }
  PartSeconds parts;
  for (const std::vector<Progress::Stage>& part : cut) parts.push_back(scalePart(part, of, to));
  return parts;
}

double sumSeconds(const PartSeconds& parts) {
  double sum = 0.0;
  for (const StageSeconds& part : parts)
    for (const auto& [stage, seconds] : part) sum += seconds;
  return sum;
}

StageSeconds stageSeconds(const PartSeconds& parts) {
  StageSeconds stages;
  for (const StageSeconds& part : parts)
    for (const auto& [stage, seconds] : part) stages[stage] += seconds;
  return stages;
}

double secondsOf(const Progress::Stage& now, const PartSeconds& before,
                 std::span<const Progress::Stage> finished) {
  // The first stage of this name goes on from what was spent before.
  return now.seconds + (ranBefore(now, finished) ? 0.0 : secondsIn(before, now.part, now.name));
}

double secondsLeft(const PartSeconds& expected, const PartSeconds& before,
                   std::span<const Progress::Stage> finished, const Progress::Stage& now) {
  const double took = secondsOf(now, before, finished);
  const std::optional<double> own = restAtRate(now, took);
  const double pace = paceOf(expected, before, finished, now, own);
  const PartSeconds spent = partSeconds(finished);
  // Once another stage begins after bounces, no further bounce of this part will come.
  const bool past_bounces =
      !isBounce(now.name) && std::ranges::any_of(finished, [&](const Progress::Stage& stage) {
        return stage.part == now.part && isBounce(stage.name);
      });
  double left = isIn(expected, now.part, now.name) ? 0.0 : own.value_or(0.0);
  for (std::size_t part = now.part; part < expected.size(); ++part)
    for (const auto& [stage, seconds] : expected[part]) {
      const double rest = paceOf(stage, pace) * seconds - secondsIn(before, part, stage);
      if (part > now.part) {
        left += std::max(0.0, rest);
      } else if (stage == now.name) {
        // The stage's own rate is used once there is one, plus what is expected of the next of the same name.
        const double of_others = rest - secondsIn(spent, part, stage) - now.seconds - own.value_or(0.0);
        left += own.value_or(0.0) + std::max(0.0, of_others);
      } else if (!isIn(spent, part, stage) && !(isBounce(stage) && past_bounces)) {
        left += std::max(0.0, rest);
      }
    }
  return left;
}

void writeSeconds(const PartSeconds& parts, ByteWriter& out) {
  out.add(std::uint64_t{parts.size()});
  for (const StageSeconds& stages : parts) {
    out.add(std::uint64_t{stages.size()});
    for (const auto& [stage, seconds] : stages) {
      out.addList(std::vector<char>(stage.begin(), stage.end()));
      out.add(seconds);
    }
  }
}

bool readSeconds(ByteReader& in, PartSeconds& parts) {
  std::uint64_t part_count = 0;
  if (!in.read(part_count)) return false;
  std::vector<char> stage;
  for (std::uint64_t p = 0; p < part_count; ++p) {
    StageSeconds& stages = parts.emplace_back();
    std::uint64_t count = 0;
    if (!in.read(count)) return false;
    for (std::uint64_t i = 0; i < count; ++i)
      if (!in.readList(stage) || !in.read(stages[std::string(stage.begin(), stage.end())])) return false;
  }
  return true;
}

}  // namespace lambent::baker
