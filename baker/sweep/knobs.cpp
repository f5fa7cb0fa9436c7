#include "baker/sweep/knobs.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/bake/option_rows.hpp"

namespace lambent::baker {

namespace {

using Side = Knob::Side;

bool hasSurfaces(const SceneFacts& facts) {
  return facts.surfaces;
}
bool isGlossy(const SceneFacts& facts) {
  return facts.glossy;
}
bool hasVolumes(const SceneFacts& facts) {
  return facts.volumes;
}
bool hasNeighborhoods(const SceneFacts& facts) {
  return facts.neighborhoods;
}
bool hasManyBodies(const SceneFacts& facts) {
  return facts.many_bodies;
}
bool hasManyProbes(const SceneFacts& facts) {
  return facts.many_probes;
}

constexpr std::string_view kPresets = "quality", kMemory = "max-memory", kKeys = "keys",
                           kFrameQuality = "frame-quality";

constexpr std::array kKnobs = {
    Knob{.name = kPresets,
         .title = "Presets",
         .about = "--quality of a bake sets rays, refinement and the error of codes together.",
         .draft_values = "draft,standard,high",
         .values = "draft,standard,high"},
    Knob{.name = "order",
         .title = "Bands",
         .about = "Bands of spherical harmonics that carry soft light: order n has n² coefficients.",
         .draft_values = "2,3,4,5,6,8",
         .values = "2,3,4,5,6,7,8"},
    Knob{.name = kKeys,
         .title = "Key lights",
         .about = "Suns and windows that are taken out of the bands and cast shadows per pixel.",
         .side = Side::Frame,
         .draft_values = "off,1,4,auto,32",
         .values = "off,1,2,4,8,auto,32",
         .usual = "auto"},
    Knob{.name = kFrameQuality,
         .title = "Quality of key shadows",
         .about = "--quality of lambent-demo: how many key lights there are and how finely they shadow.",
         .side = Side::Frame,
         .draft_values = "low,default,high",
         .values = "low,default,high",
         .usual = "default"},
    Knob{.name = "rays",
         .title = "Rays",
         .about = "Rays from each sample over its hemisphere.",
         .draft_values = "128,256,512,1024",
         .values = "128,256,512,1024,2048,4096"},
    Knob{.name = "bounces",
         .title = "Bounces",
         .about = "Interreflections between surfaces; auto stops when nothing to speak of is left.",
         .draft_values = "0,1,2,auto",
         .values = "0,1,2,3,4,8,auto"},
    Knob{.name = "refine",
         .title = "Refinement",
         .about = "Edges are split where shadows change, until interpolation errs by less than this.",
         .draft_values = "off,0.05,0.02,0.005",
         .values = "off,0.05,0.02,0.01,0.005",
         .called_for = hasSurfaces},
    Knob{.name = "fit",
         .title = "Fit to faces",
         .about = "Values at vertices are fitted to what rays from inside the faces see.",
         .draft_values = "off,on",
         .values = "off,on",
         .called_for = hasSurfaces},
    Knob{.name = "codes",
         .title = "Codes",
         .about = "The error that compressed transfer may have.",
         .draft_values = "0.03,0.01,0.003,0.001",
         .values = "0.1,0.03,0.01,0.003,0.001"},
    Knob{.name = "glossy-order",
         .title = "Bands on glossy surfaces",
         .about = "Bands of the light that glossy surfaces reflect.",
         .draft_values = "4,5,6",
         .values = "4,5,6",
         .called_for = isGlossy},
    Knob{.name = "volume-grid",
         .title = "Grid of volumes",
         .about = "Voxels along each side of the grid that holds a volume's transfer.",
         .draft_values = "8,16,32",
         .values = "8,16,32,48",
         .called_for = hasVolumes},
    Knob{.name = "neighborhood-grid",
         .title = "Grids around bodies",
         .about = "Points of the grid that says how a body changes the light around it.",
         .draft_values = "16x16x4,32x32x8,64x64x8",
         .values = "16x16x4,32x32x8,64x64x8,64x64x16",
         .called_for = hasNeighborhoods},
    Knob{.name = "light-probes",
         .title = "Light probes",
         .about = "Points of a cell at which light from nearby is sampled.",
         .draft_values = "1,4,16,auto",
         .values = "1,2,4,8,16,32,auto",
         .called_for = hasManyProbes},
    Knob{.name = "capture-size",
         .title = "Size of captures",
         .about = "Texels along an edge of the cube maps in which bodies see each other.",
         .side = Side::Frame,
         .draft_values = "4,8,16,32",
         .values = "4,8,16,32,64",
         .called_for = hasManyBodies},
    Knob{.name = "capture-subsamples",
         .title = "Supersampling of captures",
         .about = "Subsamples along an edge of each such texel.",
         .side = Side::Frame,
         .draft_values = "1,4,16",
         .values = "1,2,4,8,16",
         .called_for = hasManyBodies},
    Knob{.name = kMemory,
         .title = "Streaming detail",
         .about = "GPU memory for planes of transfer, as a share of what they take in all; meshes are always "
                  "there.",
         .side = Side::Frame,
         .draft_values = "0%,50%,75%,100%",
         .values = "0%,25%,50%,75%,90%,100%"}};

std::vector<std::string> listed(std::string_view words) {
  std::vector<std::string> list;
  while (!words.empty()) {
    const std::size_t comma = words.find(',');
    if (comma != 0) list.emplace_back(words.substr(0, comma));
    words.remove_prefix(comma == std::string_view::npos ? words.size() : comma + 1);
  }
  return list;
}

// Parses "25%".
std::optional<double> shareFrom(std::string_view word) {
  double percent = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), percent);
  if (error != std::errc{} || std::string_view(end, word.data() + word.size()) != "%") return std::nullopt;
  return percent >= 0.0 && percent <= 100.0 ? std::optional(percent / 100.0) : std::nullopt;
}

// Returns the option's name of lambent-demo for a knob.
std::string frameOption(const Knob& knob) {
  return knob.name == kFrameQuality ? "quality" : std::string(knob.name);
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
    setting.frame_words.emplace(frameOption(knob), value);
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
  const Knob* knob = findKnob(name);
  if (knob == nullptr) {
    std::vector<std::string_view> names;
    for (const Knob& known : kKnobs) names.push_back(known.name);
    return fail("--knob", fmt::format("\"{}\" is not known", name),
                fmt::format("give one of {}", fmt::join(names, ", ")));
  }
  if (equals != std::string::npos) return Asked{knob, listed(std::string_view(word).substr(equals + 1))};
  return Asked{knob, listed(quality == Quality::Draft ? knob->draft_values : knob->values)};
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

const Knob* findKnob(std::string_view name) {
  const auto found = std::ranges::find(kKnobs, name, &Knob::name);
  return found == kKnobs.end() ? nullptr : &*found;
}

std::string Setting::name() const {
  return fmt::format("{} {}", knob->name, value);
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
      if (knob.called_for == nullptr || knob.called_for(facts))
        list.push_back({&knob, listed(quality == Quality::Draft ? knob.draft_values : knob.values)});
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
