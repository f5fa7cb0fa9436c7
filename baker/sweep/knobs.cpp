#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/bake/options.hpp"
#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

namespace {

using Side = Knob::Side;

constexpr std::string_view kPresets = "quality", kMemory = "max-memory", kKeys = "keys",
                           kFrameQuality = "frame-quality";

constexpr std::array kKnobs = {
    Knob{kPresets, "Presets", "--quality of a bake sets rays, refinement and the error of codes together.",
         Side::Bake, nullptr, "draft,standard,high"},
    Knob{"order", "Bands", "Bands of spherical harmonics that carry soft light: order n has n² coefficients.",
         Side::Bake, nullptr, "2,3,4,5,6,8", "2,3,4,5,6,7,8"},
    Knob{kKeys, "Key lights", "Suns and windows that are taken out of the bands and cast shadows per pixel.",
         Side::Frame, nullptr, "off,1,4,auto,32", "off,1,2,4,8,auto,32", "auto"},
    Knob{kFrameQuality, "Quality of key shadows",
         "--quality of lambent-demo: how many key lights there are and how finely they shadow.", Side::Frame,
         nullptr, "low,default,high", "", "default"},
    Knob{"rays", "Rays", "Rays from each sample over its hemisphere.", Side::Bake, nullptr,
         "128,256,512,1024", "128,256,512,1024,2048,4096"},
    Knob{"bounces", "Bounces",
         "Interreflections between surfaces; auto stops when nothing to speak of is left.", Side::Bake,
         nullptr, "0,1,2,auto", "0,1,2,3,4,8,auto"},
    Knob{"refine", "Refinement",
         "Edges are split where shadows change, until interpolation errs by less than this.", Side::Bake,
         &SceneFacts::surfaces, "off,0.05,0.02,0.005", "off,0.05,0.02,0.01,0.005"},
    Knob{"fit", "Fit to faces", "Values at vertices are fitted to what rays from inside the faces see.",
         Side::Bake, &SceneFacts::surfaces, "off,on"},
    Knob{"codes", "Codes", "The error that compressed transfer may have.", Side::Bake, nullptr,
         "0.03,0.01,0.003,0.001", "0.1,0.03,0.01,0.003,0.001"},
    Knob{"glossy-order", "Bands on glossy surfaces", "Bands of the light that glossy surfaces reflect.",
         Side::Bake, &SceneFacts::glossy, "4,5,6"},
    Knob{"volume-grid", "Grid of volumes",
         "Voxels along each side of the grid that holds a volume's transfer.", Side::Bake,
         &SceneFacts::volumes, "8,16,32", "8,16,32,48"},
    Knob{"neighborhood-grid", "Grids around bodies",
         "Points of the grid that says how a body changes the light around it.", Side::Bake,
         &SceneFacts::neighborhoods, "16x16x4,32x32x8,64x64x8", "16x16x4,32x32x8,64x64x8,64x64x16"},
    Knob{"light-probes", "Light probes", "Points of a cell at which light from nearby is sampled.",
         Side::Bake, &SceneFacts::many_probes, "1,4,16,auto", "1,2,4,8,16,32,auto"},
    Knob{"capture-size", "Size of captures",
         "Texels along an edge of the cube maps in which bodies see each other.", Side::Frame,
         &SceneFacts::many_bodies, "4,8,16,32", "4,8,16,32,64"},
    Knob{"capture-subsamples", "Supersampling of captures", "Subsamples along an edge of each such texel.",
         Side::Frame, &SceneFacts::many_bodies, "1,4,16", "1,2,4,8,16"},
    Knob{kMemory, "Streaming detail",
         "GPU memory for planes of transfer, as a share of what they take in all; meshes are always there.",
         Side::Frame, nullptr, "0%,50%,75%,100%", "0%,25%,50%,75%,90%,100%"}};

std::vector<std::string> listed(std::string_view words) {
  std::vector<std::string> list;
  while (!words.empty()) {
    const std::size_t comma = words.find(',');
    if (comma != 0) list.emplace_back(words.substr(0, comma));
    words.remove_prefix(comma == std::string_view::npos ? words.size() : comma + 1);
  }
  return list;
}

std::vector<std::string> valuesOf(const Knob& knob, Quality quality) {
  return listed(quality == Quality::Draft || knob.values.empty() ? knob.draft_values : knob.values);
}

// Parses "25%".
std::optional<double> shareFrom(std::string_view word) {
  double percent = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), percent);
  if (error != std::errc{} || std::string_view(end, word.data() + word.size()) != "%") return std::nullopt;
  return percent >= 0.0 && percent <= 100.0 ? std::optional(percent / 100.0) : std::nullopt;
}

Result<Setting> settingOf(const Knob& knob, const std::string& value, Quality quality) {
  Setting setting{
      .knob = &knob, .value = value, .bake = {.quality = quality}, .bake_words = {}, .frame_words = {}};
  if (knob.side == Side::Bake) {
    if (auto put = putOption(setting.bake, knob.name, value); !put) return failAgain(std::move(put.error()));
    if (knob.name != kPresets) setting.bake_words.emplace(knob.name, value);
  } else if (knob.name == kMemory) {
    const auto share = shareFrom(value);
    if (!share)
      return fail("--knob max-memory", fmt::format("\"{}\" is no share", value), "give one like 50%");
    setting.memory_share = *share;
  } else if (value != knob.usual) {
    setting.frame_words.emplace(knob.name == kFrameQuality ? kPresets : knob.name, value);
  }
  return setting;
}

struct Asked {
  const Knob* knob = nullptr;
  std::vector<std::string> values;
};

Result<Asked> understand(const std::string& word, Quality quality) {
  const std::size_t equals = word.find('=');
  const std::string name = word.substr(0, equals);
  const auto knob = std::ranges::find(kKnobs, name, &Knob::name);
  if (knob == kKnobs.end()) {
    std::vector<std::string_view> names;
    for (const Knob& known : kKnobs) names.push_back(known.name);
    return fail("--knob", fmt::format("\"{}\" is not known", name),
                fmt::format("give one of {}", fmt::join(names, ", ")));
  }
  if (equals == std::string::npos) return Asked{&*knob, valuesOf(*knob, quality)};
  return Asked{&*knob, listed(std::string_view(word).substr(equals + 1))};
}

// Bakes with glossy surfaces have at most six bands.
bool possible(const Setting& setting, const SceneFacts& facts) {
  constexpr int kMostGlossyBands = 6;
  return !facts.glossy || setting.bake.order <= kMostGlossyBands;
}

}  // namespace

SceneFacts factsOf(const EffectPlan& plan) {
  SceneFacts facts{.surfaces = plan.bakes("diffuse") || plan.bakes("glossy"),
                   .glossy = plan.bakes("glossy"),
                   .volumes = plan.bakes("volume"),
                   .neighborhoods = plan.bakes("neighborhood"),
                   .many_bodies = plan.groups.size() > 1};
  facts.many_probes =
      std::ranges::any_of(plan.light_probes, [](const PlannedLightProbes& p) { return p.count.count > 1; });
  return facts;
}

std::span<const Knob> knobs() {
  return kKnobs;
}

std::string Setting::name() const {
  return isPreset() ? value + " quality" : fmt::format("{} {}", knob->name, value);
}

std::string Setting::command() const {
  std::string words = "lambent-demo";
  if (isBaked()) words = fmt::format("lambent bake --quality {}", qualityName(bake.quality));
  for (const auto* options : {&bake_words, &frame_words})
    for (const auto& [option, word] : *options) words += fmt::format(" --{} {}", option, word);
  if (memory_share < 1.0) words += fmt::format(" --max-memory …   ({})", value);
  return words;
}

bool Setting::isPreset() const {
  return knob->name == kPresets;
}

bool Setting::isOfKeyLights() const {
  return knob->name == kKeys || knob->name == kFrameQuality;
}

Result<std::vector<Setting>> settingsOf(const SceneFacts& facts, Quality quality,
                                        std::span<const std::string> asked) {
  std::vector<Asked> list;
  for (const std::string& word : asked) {
    auto one = understand(word, quality);
    if (!one) return failAgain(std::move(one.error()));
    list.push_back(std::move(*one));
  }
  if (list.empty())
    for (const Knob& knob : kKnobs)
      if (knob.called_for == nullptr || facts.*knob.called_for)
        list.push_back({&knob, valuesOf(knob, quality)});
  // The base comes first.
  std::vector<Setting> settings = {*settingOf(kKnobs.front(), qualityName(quality), quality)};
  for (const Asked& one : list)
    for (const std::string& value : one.values) {
      auto setting = settingOf(*one.knob, value, quality);
      if (!setting) return failAgain(std::move(setting.error()));
      const bool is_base = setting->isPreset() && value == settings.front().value;
      if (!is_base && possible(*setting, facts)) settings.push_back(std::move(*setting));
    }
  return settings;
}

}  // namespace lambent::baker
