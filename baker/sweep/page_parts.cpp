#include "baker/sweep/page_parts.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/sweep/chart.hpp"
#include "baker/sweep/escape.hpp"
#include "baker/sweep/units.hpp"

namespace lambent::baker {

namespace {

std::vector<const Measured*> ofKnob(const SweepResults& results, const Knob& knob) {
  std::vector<const Measured*> list;
  for (const Measured& measured : results.settings)
    if (measured.setting.knob == &knob) list.push_back(&measured);
  if (knob.name == "quality")  // the base came first
    std::ranges::stable_sort(list, {}, [](const Measured* m) { return m->setting.bake.quality; });
  return list;
}

// Returns a command line that gives this setting.
std::string commandOf(const Measured& measured) {
  const Setting& setting = measured.setting;
  std::string words = setting.isBaked()
                          ? fmt::format("lambent bake --quality {}", qualityName(setting.bake.quality))
                          : "lambent-demo";
  for (const auto* options : {&setting.bake_words, &setting.frame_words})
    for (const auto& [name, value] : *options) words += fmt::format(" --{} {}", name, value);
  if (setting.memory_share < 1.0) words += fmt::format(" --max-memory …   ({})", setting.value);
  return words;
}

using Segment = std::pair<std::string, double>;  // a cause and its size

// Draws bars of segments, the longest as wide as the card.
struct Bar {
  std::string name, text;
  double length = 0.0;
  std::vector<double> shares;  // of the segments
};

std::string barsOf(const std::vector<Bar>& bars, const std::vector<std::string>& names,
                   const char* unknown = nullptr) {
  double longest = 1e-12;
  for (const Bar& bar : bars) longest = std::max(longest, bar.length);
  std::string out = "<div class=\"key\">";
  for (std::size_t i = 0; i < names.size(); ++i)
    out += fmt::format("<span><i class=\"part-{}\"></i>{}</span>", i + 1, htmlText(names[i]));
  if (unknown != nullptr) out += fmt::format("<span><i class=\"part-6\"></i>{}</span>", unknown);
  out += "</div>\n<div class=\"bars\">\n";
  for (const Bar& bar : bars) {
    out += fmt::format("<span>{}</span><span class=\"bar\"><span class=\"stack\" style=\"width:{:.1f}%\">",
                       htmlText(bar.name), 82.0 * bar.length / longest);
    for (std::size_t i = 0; i < bar.shares.size(); ++i)
      if (bar.shares[i] > 0.0)
        out += fmt::format("<i class=\"part-{}\" style=\"width:{:.2f}%\" title=\"{}: {:.0f} %\"></i>", i + 1,
                           100.0 * bar.shares[i], i < names.size() ? htmlText(names[i]) : unknown,
                           100.0 * bar.shares[i]);
    out += fmt::format("</span>{}</span>\n", htmlText(bar.text));
  }
  return out + "</div>\n";
}

// Draws bars of the errors of some settings: lengths are errors, segments shares of their squares.
std::string errorBars(const std::vector<const Measured*>& list) {
  std::vector<Bar> bars;
  bool any_unknown = false;
  for (const Measured* m : list) {
    const ErrorParts parts = partsOf(*m);
    const double all = m->picture.as_light_is.rms, square = std::max(all * all, 1e-18);
    const auto share = [&](double part) { return part * part / square; };
    Bar bar{titleOf(*m), percent(all), all, {}};
    if (parts.noise) {
      bar.shares = {share(*parts.noise), share(*parts.codes), share(*parts.interpolation),
                    share(parts.beyond_bands)};
    } else {
      any_unknown = true;
      bar.shares = {0.0, 0.0, 0.0, share(parts.beyond_bands), 0.0, share(parts.within_bands)};
    }
    bars.push_back(std::move(bar));
  }
  return barsOf(bars, {"noise of rays", "codes", "interpolation", "beyond the bands"},
                any_unknown ? "within the bands, not divided" : nullptr);
}

// Bars of times. The five names that take longest anywhere have a segment of their own.
std::string timeBars(const std::vector<const Measured*>& list, NamedTimes (*times_of)(const Measured&),
                     std::string (*text)(double)) {
  std::map<std::string, double> most;
  for (const Measured* m : list)
    for (const auto& [name, time] : times_of(*m)) most[name] = std::max(most[name], time);
  std::vector<Segment> order(most.begin(), most.end());
  std::ranges::stable_sort(order, std::ranges::greater(), &Segment::second);
  constexpr std::size_t kNamed = 5;
  if (order.size() > kNamed) order.resize(kNamed);
  std::vector<std::string> names;
  for (const Segment& one : order) names.push_back(one.first);
  std::vector<Bar> bars;
  for (const Measured* m : list) {
    Bar bar{titleOf(*m), "", 0.0, std::vector<double>(kNamed + 1)};
    for (const auto& [name, time] : times_of(*m)) {
      const auto found = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
      bar.shares[found < names.size() ? found : kNamed] += time;
      bar.length += time;
    }
    for (double& share : bar.shares) share /= std::max(bar.length, 1e-12);
    bar.text = text(bar.length);
    bars.push_back(std::move(bar));
  }
  return barsOf(bars, names, "all others");
}

}  // namespace

Plot plotOf(const SweepResults& results, const Cost& cost, const Advice& advice) {
  Plot plot{.title = fmt::format("{}: error against {}", results.scene, cost.words),
            .x_title = cost.title,
            .y_title = "error of the picture (relative RMS)",
            .x_text = cost.text,
            .y_text = tickPercent,
            .points = {},
            .front = {}};
  for (const std::size_t i : advice.competing) {
    const Measured& m = results.settings[i];
    const bool on_front = std::ranges::find(advice.front, i) != advice.front.end();
    const double x = cost.of(m), y = m.picture.as_light_is.rms;
    PlotPoint point{.x = x,
                    .y = y,
                    .y_spread = m.picture.as_light_is.rms_spread,
                    .id = m.key,
                    .about = fmt::format("{}: {} for {}", titleOf(m), percent(y), cost.text(x)),
                    .label = m.setting.isPreset() ? m.setting.value : titleOf(m),
                    .always_labelled = m.setting.isPreset() || on_front,
                    .on_front = on_front,
                    .chosen = advice.chosen == i};
    plot.points.push_back(std::move(point));
  }
  for (const std::size_t i : advice.front)
    plot.front.push_back(
        static_cast<std::size_t>(std::ranges::find(advice.competing, i) - advice.competing.begin()));
  return plot;
}

std::string answersPart(const SweepResults& results) {
  std::string out = "<div class=\"answers\">\n";
  for (const std::size_t of : {std::size_t{0}, std::size_t{1}}) {
    const Cost& cost = costs()[of];
    const Advice advice = adviceOn(cost, results.settings);
    if (!advice.chosen) continue;
    const Measured& chosen = results.settings[*advice.chosen];
    out += fmt::format(
        "<div class=\"card\"><span "
        "class=\"faint\">{}</span><strong>{}</strong><p>{}</p><code>{}</code></div>\n",
        cost.verb, htmlText(titleOf(chosen)), htmlText(advice.reason), htmlText(commandOf(chosen)));
  }
  return out + "</div>\n";
}

std::string plotsPart(const SweepResults& results) {
  std::string out = "<div class=\"tabs\">\n";
  bool first = true;
  for (const Cost& cost : costs()) {
    const Advice advice = adviceOn(cost, results.settings);
    out += fmt::format(
        "<input type=\"radio\" name=\"cost\" id=\"{0}\"{1}><label for=\"{0}\">{2}</label>\n"
        "<figure class=\"panel card\" style=\"margin:8px 0\">{3}</figure>\n",
        cost.id, first ? " checked" : "", cost.words,
        svgOf(plotOf(results, cost, advice), PlotPlace::InPage));
    first = false;
  }
  return out + "</div>\n";
}

std::string knobsPart(const SweepResults& results) {
  std::string out =
      "<div class=\"key\"><span><i class=\"line\"></i>error, light as it is</span>"
      "<span><i class=\"dashed\"></i>error, light as the bands can show</span>"
      "<span><i class=\"cost\"></i>time of the bake or the frame</span></div>\n<div class=\"knobs\">\n";
  for (const Knob& knob : knobs()) {
    const std::vector<const Measured*> list = ofKnob(results, knob);
    if (list.size() < 2 && knob.name != "max-memory") continue;
    if (list.empty()) continue;
    std::vector<ChartColumn> columns;
    for (const Measured* m : list) {
      const bool baked = m->setting.isBaked();
      columns.push_back(
          {.value = m->setting.value,
           .error = m->picture.as_light_is.rms,
           .error_of_bands = m->picture.as_bands_can.rms,
           .cost = baked ? m->bake.processor_seconds : m->picture.costMs(),
           .cost_text = baked ? seconds(m->bake.processor_seconds) : milliseconds(m->picture.costMs()),
           .other_text = bytes(static_cast<double>(baked ? m->bake.bytes : m->picture.gpu_bytes)),
           .id = m->key,
           .base = m->key == results.settings.front().key});
    }
    out += fmt::format("<div class=\"card\"><h3>{}</h3><p class=\"faint\">{}</p>{}<p>{}</p></div>\n",
                       htmlText(knob.title), htmlText(knob.about), chartOf(std::string(knob.title), columns),
                       htmlText(effectOf(list)));
  }
  return out + "</div>\n";
}

std::string causesPart(const SweepResults& results) {
  std::vector<const Measured*> presets = ofKnob(results, *findKnob("quality"));
  std::vector<const Measured*> errors = presets, frames = {&results.settings.front()};
  for (const Measured& m : results.settings) {
    if (m.setting.isOfKeyLights() && m.key != results.settings.front().key) frames.push_back(&m);
    const bool without_keys = m.setting.knob->name == "keys" && m.setting.value == "off";
    if ((m.setting.knob->name == "order" || without_keys) && m.key != results.settings.front().key)
      errors.push_back(&m);
  }
  return "<div class=\"card\"><h3>Of the error</h3>"
         "<p class=\"faint\">A bar is as long as the error; its parts are shares of the squares, which add "
         "up. "
         "Beyond the bands lies what they cannot carry, less what key lights bring back.</p>" +
         errorBars(errors) + "</div>\n<div class=\"card\"><h3>Of a bake, by the clock</h3>" +
         timeBars(
             presets, [](const Measured& m) { return m.bake.stages; }, seconds) +
         "</div>\n<div class=\"card\"><h3>Of a frame, by the clock</h3>"
         "<p class=\"faint\">The last of some frames under turning light, so that nothing is kept from the "
         "one before.</p>" +
         timeBars(
             frames, [](const Measured& m) { return m.picture.passes; }, milliseconds) +
         "</div>\n";
}

}  // namespace lambent::baker
