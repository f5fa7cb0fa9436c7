#include "baker/sweep/csv.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/sweep/advice.hpp"
#include "baker/sweep/escape.hpp"

namespace lambent::baker {

namespace {

std::string number(double value) {
  return fmt::format("{:.6g}", value);
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : std::string();
}

}  // namespace

std::string settingsCsv(const SweepResults& results) {
  std::vector<Advice> advice;
  for (const Cost& cost : costs()) advice.push_back(adviceOn(cost, results.settings));
  static constexpr std::array kColumns = {"scene",
                                          "knob",
                                          "value",
                                          "error",
                                          "error_spread",
                                          "percentile_99",
                                          "visible",
                                          "bias",
                                          "bands_error",
                                          "bands_percentile_99",
                                          "noise",
                                          "codes",
                                          "interpolation",
                                          "beyond_bands",
                                          "bake_processor_s",
                                          "bake_s",
                                          "bake_least_s",
                                          "bake_most_s",
                                          "bake_runs",
                                          "frame_ms",
                                          "frame_slowest_ms",
                                          "frame_processor_ms",
                                          "bundle_bytes",
                                          "transfer_bytes",
                                          "gpu_bytes",
                                          "vertices",
                                          "key_lights",
                                          "on_front",
                                          "machine",
                                          "renderer"};
  std::string out = fmt::format("{}\n", fmt::join(kColumns, ","));
  for (std::size_t i = 0; i < results.settings.size(); ++i) {
    const Measured& m = results.settings[i];
    const Figures &lit = m.picture.as_light_is, &banded = m.picture.as_bands_can;
    const ErrorParts parts = partsOf(m);
    std::vector<std::string> fronts;
    for (std::size_t c = 0; c < advice.size(); ++c)
      if (std::ranges::find(advice[c].front, i) != advice[c].front.end()) fronts.emplace_back(costs()[c].id);
    const std::vector<std::string> fields = {csvField(results.scene),
                                             csvField(m.setting.knob->name),
                                             csvField(m.setting.value),
                                             number(lit.rms),
                                             number(lit.rms_spread),
                                             number(lit.percentile_99),
                                             number(m.visible),
                                             number(lit.bias),
                                             number(banded.rms),
                                             number(banded.percentile_99),
                                             number(parts.noise),
                                             number(parts.codes),
                                             number(parts.interpolation),
                                             number(parts.beyond_bands),
                                             number(m.bake.processor_seconds),
                                             number(m.bake.seconds),
                                             number(m.bake.least_seconds),
                                             number(m.bake.most_seconds),
                                             std::to_string(m.bake.runs),
                                             number(m.picture.frame_ms),
                                             number(m.picture.slowest_ms),
                                             number(m.picture.processor_ms),
                                             std::to_string(m.bake.bytes),
                                             std::to_string(m.bake.transfer_bytes),
                                             std::to_string(m.picture.gpu_bytes),
                                             std::to_string(m.bake.vertices),
                                             std::to_string(m.picture.key_lights),
                                             csvField(fmt::format("{}", fmt::join(fronts, " "))),
                                             csvField(results.machine),
                                             csvField(m.picture.renderer)};
    out += fmt::format("{}\n", fmt::join(fields, ","));
  }
  return out;
}

std::string timesCsv(const SweepResults& results) {
  std::string out = "scene,knob,value,of,name,ms\n";
  for (const Measured& m : results.settings) {
    const auto line = [&](const char* of, const std::string& name, double ms) {
      out += fmt::format("{},{},{},{},{},{}\n", csvField(results.scene), csvField(m.setting.knob->name),
                         csvField(m.setting.value), of, csvField(name), number(ms));
    };
    for (const auto& [name, time] : m.bake.stages) line("bake", name, 1000.0 * time);
    for (const auto& [name, time] : m.picture.passes) line("frame", name, time);
  }
  return out;
}

}  // namespace lambent::baker
