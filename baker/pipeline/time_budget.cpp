#include "baker/pipeline/time_budget.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "baker/bake/option_rows.hpp"
#include "baker/pipeline/bake_estimate.hpp"

namespace lambent::baker {

namespace {

// A finer preset takes at least so many times as long. It is not rehearsed if even this is too much.
constexpr double kNextTakes = 1.5;
constexpr std::uint32_t kLeastRays = 128, kRaysStep = 16;

// A number with two digits, so that the word for it is short and stands for just this number.
float rounded(double value) {
  return std::stof(fmt::format("{:.2g}", value));
}

double mix(double coarse, double fine, double at) {
  return coarse * std::pow(fine / coarse, at);
}

TimedOptions withWords(const BakeOptions& options, double seconds) {
  TimedOptions timed{options, seconds, {}};
  for (const char* name : {"quality", "rays", "refine", "codes"})
    timed.words +=
        fmt::format("{}--{} {}", timed.words.empty() ? "" : " ", name, findOption(name)->word(options));
  return timed;
}

}  // namespace

BakeOptions between(const BakeOptions& coarse, const BakeOptions& fine, const BakeOptions& asked, double at) {
  BakeOptions options = coarse;
  if (asked.rays == 0) {
    const double rays =
        mix(static_cast<double>(coarse.effectiveRays()), static_cast<double>(fine.effectiveRays()), at);
    options.rays = kRaysStep * static_cast<std::uint32_t>(std::lround(rays / kRaysStep));
  }
  if (asked.refine_bound < 0.0f)
    options.refine_bound =
        rounded(mix(double{coarse.effectiveRefineBound()}, double{fine.effectiveRefineBound()}, at));
  if (asked.error_bound == 0.0f)
    options.error_bound =
        rounded(mix(double{coarse.effectiveErrorBound()}, double{fine.effectiveErrorBound()}, at));
  return options;
}

Result<TimedOptions> optionsForTime(const Scene& scene, const BakeOptions& asked, double seconds,
                                    const BakeContext& context) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto left = [&] { return seconds - std::chrono::duration<double>(Clock::now() - began).count(); };
  const auto plan = planFor(scene, asked);
  if (!plan) return failAgain(plan.error());
  std::optional<TimedOptions> fits;
  for (const Quality quality : {Quality::Draft, Quality::Standard, Quality::High}) {
    if (fits && kNextTakes * fits->seconds > left()) break;
    BakeOptions options = asked;
    options.quality = quality;
    const auto estimate = estimateBake(scene, options, context);
    if (!estimate) return failAgain(estimate.error());
    if (estimate->seconds <= left()) {
      fits = withWords(options, estimate->seconds);
      continue;
    }
    if (fits) {
      // Time is taken to grow evenly in ratios, as rays and bounds do.
      const double at = std::log(left() / fits->seconds) / std::log(estimate->seconds / fits->seconds);
      if (!(at > 0.0)) break;
      BakeOptions chosen = between(fits->options, options, asked, at);
      if (plan->bakes("glossy")) chosen.error_bound = asked.error_bound;
      const double takes = mix(fits->seconds, estimate->seconds, at);
      return withWords(chosen, takes);
    }
    // Nothing is coarser than a draft but fewer rays.
    BakeOptions fewer = options;
    if (asked.rays == 0) fewer.rays = kLeastRays;
    const double share =
        static_cast<double>(fewer.effectiveRays()) / static_cast<double>(options.effectiveRays());
    return withWords(fewer, estimate->seconds * std::sqrt(share));
  }
  return *fits;
}

}  // namespace lambent::baker
