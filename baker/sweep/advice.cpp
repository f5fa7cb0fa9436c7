#include "baker/sweep/advice.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "baker/sweep/pareto.hpp"
#include "baker/sweep/units.hpp"

namespace lambent::baker {

namespace {

bool changesTheBake(const Measured& measured, const Measured& base) {
  return measured.setting.isBaked() || measured.key == base.key;
}

bool changesTheFrame(const Measured& measured, const Measured& base) {
  return !measured.setting.isBaked() || measured.key == base.key;
}

constexpr std::array kCosts = {
    Cost{"bake-time", "processor time of a bake, all threads together", "time of a bake", "Bake with",
         seconds, [](const Measured& m) { return m.bake.processor_seconds; }, changesTheBake},
    Cost{"frame-time", "time of a frame under turning light", "time of a frame", "Draw with", milliseconds,
         [](const Measured& m) { return m.picture.costMs(); }, changesTheFrame},
    Cost{"bundle-bytes", "bytes of the bundle", "bytes of the bundle", "Bake with", bytes,
         [](const Measured& m) { return static_cast<double>(m.bake.bytes); }, changesTheBake},
    Cost{"gpu-bytes", "bytes on the GPU", "bytes on the GPU", "Draw with", bytes,
         [](const Measured& m) { return static_cast<double>(m.picture.gpu_bytes); }, changesTheFrame}};

}  // namespace

std::span<const Cost> costs() {
  return kCosts;
}

std::string titleOf(const Measured& measured) {
  return measured.setting.isPreset() ? measured.setting.value + " quality" : measured.setting.name();
}

Advice adviceOn(const Cost& cost, std::span<const Measured> settings) {
  Advice advice;
  std::set<std::string> seen;
  for (const bool presets : {true, false})  // of equal ones the preset is the better name
    for (std::size_t i = 0; i < settings.size(); ++i)
      if (settings[i].setting.isPreset() == presets && cost.competes(settings[i], settings.front()) &&
          seen.insert(settings[i].key).second)
        advice.competing.push_back(i);
  std::vector<CostAndError> points;
  for (const std::size_t i : advice.competing)
    points.push_back({cost.of(settings[i]), settings[i].picture.as_light_is.rms,
                      settings[i].picture.as_light_is.rms_spread});
  std::vector<std::size_t> front = paretoFront(points);
  const std::optional<std::size_t> knee = kneeOf(points, front);
  if (!knee) return advice;
  const auto said = [&](std::size_t i) {
    return fmt::format("{} for {}", percent(points[i].error), cost.text(points[i].cost));
  };
  advice.reason = fmt::format("It errs by {}.", said(*knee));
  const auto place = std::ranges::find(front, *knee);
  if (place == front.begin() && front.size() > 1) advice.reason += " It is the cheapest.";
  if (place != front.begin()) {
    const std::size_t before = *(place - 1);
    advice.reason += fmt::format(" The next cheaper one on the front, {}, errs by {}.",
                                 titleOf(settings[advice.competing[before]]), said(before));
  }
  if (place + 1 == front.end())
    advice.reason += " Nothing that was measured errs less.";
  else
    advice.reason += fmt::format(
        " Beyond it, no setting takes a tenth of the error away for each doubling of the {}: the most exact "
        "one, {}, "
        "errs by {}.",
        cost.words, titleOf(settings[advice.competing[front.back()]]), said(front.back()));
  advice.chosen = advice.competing[*knee];
  for (const std::size_t i : front) advice.front.push_back(advice.competing[i]);
  return advice;
}

std::string effectOf(std::span<const Measured* const> of_knob) {
  constexpr double kHardly = 0.05;  // a twentieth of the error
  if (of_knob.size() < 2) return {};
  const auto error = [](const Measured* m) { return m->picture.as_light_is.rms; };
  const auto [least, most] = std::ranges::minmax(of_knob, {}, error);
  if (error(most) - error(least) < kHardly * error(most))
    return fmt::format("Here it hardly matters: between {} and {}.", percent(error(least)),
                       percent(error(most)));
  const Measured &first = *of_knob.front(), &last = *of_knob.back();
  const bool baked = first.setting.isBaked();
  const double times = baked ? last.bake.processor_seconds / first.bake.processor_seconds
                             : last.picture.costMs() / first.picture.costMs();
  const char* of = baked ? "a bake" : "a frame";
  constexpr double kAlike = 1.1;
  const std::string time = times < kAlike && times > 1.0 / kAlike
                               ? "in about the same time"
                               : fmt::format("at {:.2g} times the time of {}", times, of);
  return fmt::format("From {} to {} the error goes from {} to {}, {}.", first.setting.value,
                     last.setting.value, percent(error(&first)), percent(error(&last)), time);
}

}  // namespace lambent::baker
