#include "baker/pipeline/whole_progress.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "baker/bake/bake.hpp"
#include "baker/cache/bytes.hpp"

namespace lambent::baker {

namespace {

// Measured times count against this share of all that was expected, so that the first short stages say
// little.
constexpr double kPaceBegins = 0.05;
// The share of a job that is not done is at most this: what was expected may be over before the job is.
constexpr double kMostBeforeTheEnd = 0.99;

bool isIn(const PartSeconds& parts, std::size_t part, const std::string& stage) {
  return part < parts.size() && parts[part].contains(stage);
}

double secondsIn(const PartSeconds& parts, std::size_t part, const std::string& stage) {
  return isIn(parts, part, stage) ? parts[part].at(stage) : 0.0;
}

double& secondsAt(PartSeconds& parts, const Progress::Stage& stage) {
  if (stage.part >= parts.size()) parts.resize(stage.part + 1);
  return parts[stage.part][stage.name];
}

bool isBounce(std::string_view stage) {
  return stage.starts_with("bounce ");
}

bool tracesRays(const std::string& stage) {
  static constexpr std::array kStages = {"direct light",       "glossy shadows", "inside faces", "paths",
                                         "light into volumes", "scattering",     "neighborhood", kRefinement};
  return isBounce(stage) || std::ranges::find(kStages, stage) != kStages.end();
}

std::uint64_t computedUnits(const Progress::Stage& stage) {
  return stage.done - std::min(stage.done, stage.found_units);
}

// Returns the seconds that the stage would have taken to get where it is without the cache, if it shows them.
std::optional<double> secondsOf(const Progress::Stage& stage) {
  if (!stage.found) return stage.seconds;
  const std::uint64_t computed = computedUnits(stage);
  if (stage.found_units == 0 || computed == 0) return std::nullopt;
  return stage.seconds * static_cast<double>(stage.done) / static_cast<double>(computed);
}

// Returns the seconds that the rest of the stage takes at its rate so far, once that says something.
std::optional<double> restAtRate(const Progress::Stage& now) {
  constexpr double kLeast_s = 0.2, kMost_s = 2.0, kLeastShare = 0.05;
  const auto computed = static_cast<double>(computedUnits(now)), total = static_cast<double>(now.total);
  if (now.total == 0 || computed == 0.0 || now.seconds <= kLeast_s) return std::nullopt;
  // The first samples wait for what all need.
  if (now.seconds <= kMost_s && computed < kLeastShare * total) return std::nullopt;
  return now.seconds * std::max(0.0, total - static_cast<double>(now.done)) / computed;
}

// Returns how long stages that trace rays take, times what was expected. Those that take longer have more
// samples, or a slower machine, and so have those to come; and the reverse. `own` is how much longer the
// running stage takes at its rate, if it has one.
double paceOf(const PartSeconds& expected, std::span<const Progress::Stage> finished,
              const Progress::Stage& now, std::optional<double> own) {
  PartSeconds known;
  const auto add = [&](const Progress::Stage& stage, double more) {
    if (const auto seconds = secondsOf(stage)) secondsAt(known, stage) += *seconds + more;
  };
  for (const Progress::Stage& stage : finished) add(stage, 0.0);
  // Refinement learns only as it goes how much there is to do.
  if (own && now.name != kRefinement) add(now, *own);
  double took = 0.0, expected_of_these = 0.0, all = 0.0;
  for (std::size_t part = 0; part < expected.size(); ++part)
    for (const auto& [stage, seconds] : expected[part]) {
      if (!tracesRays(stage)) continue;
      all += seconds;
      if (!isIn(known, part, stage)) continue;
      took += secondsIn(known, part, stage);
      expected_of_these += seconds;
    }
  const double begins = kPaceBegins * all;
  return all > 0.0 ? (took + begins) / (expected_of_these + begins) : 1.0;
}

// Codes take longer where there are more samples, but no shorter where rays do.
double paceOf(const std::string& stage, double of_rays) {
  if (tracesRays(stage)) return of_rays;
  return stage.starts_with("coding") ? std::max(1.0, of_rays) : 1.0;
}

}  // namespace

double sumSeconds(const PartSeconds& parts) {
  double sum = 0.0;
  for (const StageSeconds& part : parts)
    for (const auto& [stage, seconds] : part) sum += seconds;
  return sum;
}

JobSeconds jobSeconds(const PartSeconds& expected, std::span<const Progress::Stage> finished,
                      const Progress::Stage& now) {
  const std::optional<double> own = restAtRate(now);
  const double pace = paceOf(expected, finished, now, own);
  // Work that the cache held counts as much as if it had been computed.
  const auto spentOn = [&](const Progress::Stage& stage) {
    if (const auto seconds = secondsOf(stage)) return *seconds;
    const double share =
        stage.total > 0 ? static_cast<double>(stage.done) / static_cast<double>(stage.total) : 1.0;
    return std::max(stage.seconds,
                    share * paceOf(stage.name, pace) * secondsIn(expected, stage.part, stage.name));
  };
  JobSeconds job;
  PartSeconds spent;
  for (const Progress::Stage& stage : finished) {
    const double seconds = spentOn(stage);
    secondsAt(spent, stage) += seconds;
    job.spent += seconds;
  }
  const double spent_now = spentOn(now);
  job.spent += spent_now;
  // Once another stage begins after bounces, no further bounce of this part will come.
  const bool past_bounces =
      !isBounce(now.name) && std::ranges::any_of(finished, [&](const Progress::Stage& stage) {
        return stage.part == now.part && isBounce(stage.name);
      });
  const double rest_now = own.value_or(0.0);
  if (!isIn(expected, now.part, now.name)) job.left = rest_now;
  for (std::size_t part = now.part; part < expected.size(); ++part)
    for (const auto& [stage, seconds] : expected[part]) {
      const double all = paceOf(stage, pace) * seconds;
      if (part == now.part && stage == now.name) {
        // The stage's own rate is used once there is one, plus what is expected of the next of the same name.
        job.left += rest_now + std::max(0.0, all - secondsIn(spent, part, stage) - spent_now - rest_now);
      } else if (part > now.part || (!isIn(spent, part, stage) && !(isBounce(stage) && past_bounces))) {
        job.left += all;
      }
    }
  return job;
}

WholeProgress::Seen WholeProgress::look(const Progress& progress) {
  Seen seen;
  seen.stage = progress.now();
  JobSeconds job = jobSeconds(expected_, progress.finished(), seen.stage);
  job.spent += others_.spent, job.left += others_.left;
  if (seen.stage.seconds > 0.0)
    seen.units_per_s = static_cast<double>(computedUnits(seen.stage)) / seen.stage.seconds;
  // What is left is known better as stages run, and a share that falls would say that work was lost.
  const double all = job.spent + job.left;
  if (all > 0.0) share_ = std::max(share_, std::min(kMostBeforeTheEnd, job.spent / all));
  seen.share = share_;
  seen.seconds_left = std::min(job.left, (1.0 - share_) * all);
  return seen;
}

ProgressWatch::ProgressWatch(const Progress& progress, WholeProgress whole,
                             std::chrono::duration<double> every,
                             std::function<void(const WholeProgress::Seen&)> say, bool at_end)
    : thread_([&progress, whole = std::move(whole), every, say = std::move(say),
               at_end](std::stop_token stop) mutable {
        std::mutex lock;
        std::condition_variable_any ended;  // lets the end come before the next turn
        std::unique_lock hold(lock);
        while (!ended.wait_for(hold, stop, every, [&] { return stop.stop_requested(); }))
          say(whole.look(progress));
        if (at_end) say(whole.look(progress));
      }) {}

Key progressKey(const Scene& scene, const BakeOptions& options) {
  KeyMaker key = KeyMaker::ofStage("share");
  key.add(sceneDigest(scene));
  for (const auto& [name, word] : options.settings()) key.addText(name).addText(word);
  return key.key();
}

double findProgress(const Key& key, const Cache& cache) {
  const auto bytes = cache.find(key);
  if (!bytes) return 0.0;
  ByteReader in(*bytes);
  double share = 0.0;
  return in.read(share) && in.atEnd() && share > 0.0 && share < 1.0 ? share : 0.0;
}

ProgressWatch keepProgress(const Progress& progress, WholeProgress whole, Cache& cache, const Key& key) {
  constexpr double kEvery_s = 1.0;
  const std::chrono::duration<double> every(std::min(kEvery_s, cache.checkpointEvery()));
  return {progress, std::move(whole), every, [&cache, key](const WholeProgress::Seen& seen) {
            ByteWriter out;
            out.add(seen.share);
            cache.put(key, out.bytes());
          }};
}

}  // namespace lambent::baker
