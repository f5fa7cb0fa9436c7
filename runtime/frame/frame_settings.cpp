#include "runtime/frame/frame_settings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "runtime/spec/numbers.hpp"
#include "runtime/surface/reflection_probes_shared.h"

namespace lambent::frame {

namespace {

using Kind = SettingRow::Kind;

// The words are in the order of the enums' values.
constexpr std::array<std::string_view, 3> kTransferWords = {"unshadowed", "shadowed", "full"};
constexpr std::array<std::string_view, 2> kWindowWords = {"off", "auto"};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

using S = FrameSettings;
using C = lighting::CaptureOptions;

// Returns a member of the settings, or of the capture's options.
template <auto Member>
auto& memberOf(auto& settings) {
  if constexpr (requires { settings.*Member; })
    return settings.*Member;
  else
    return settings.capture.*Member;
}

// Returns the row of a member. Its type gives the kind.
template <auto Member>
constexpr SettingRow rowFor(SettingRow row) {
  using T = std::remove_cvref_t<decltype(memberOf<Member>(std::declval<S&>()))>;
  row.kind = std::is_same_v<T, bool>       ? Kind::Switch
             : std::is_enum_v<T>           ? Kind::Choice
             : std::is_floating_point_v<T> ? Kind::Real
                                           : Kind::Whole;
  row.get = [](const S& settings) { return static_cast<double>(memberOf<Member>(settings)); };
  row.put = [](S& settings, double value) {
    if constexpr (std::is_enum_v<T>)
      memberOf<Member>(settings) = static_cast<T>(static_cast<int>(value));
    else
      memberOf<Member>(settings) = static_cast<T>(value);
  };
  return row;
}

// Returns the row of a number or a switch. Its greatest value is the most accurate one.
template <auto Member>
constexpr SettingRow rowFor(std::string_view name, std::string_view label, double least, double greatest,
                            std::string_view help, std::string_view former = {}) {
  return rowFor<Member>({.name = name,
                         .label = label,
                         .least = least,
                         .greatest = greatest,
                         .finest = greatest,
                         .help = help,
                         .former = former});
}
template <auto Member>
constexpr SettingRow rowFor(std::string_view name, std::string_view label, std::string_view help,
                            std::string_view former = {}) {
  return rowFor<Member>(name, label, 0.0, 1.0, help, former);
}

const std::array kRows = {
    rowFor<&S::transfer>({.name = "transfer",
                          .label = "shadows and bounces",
                          .greatest = 2.0,
                          .words = kTransferWords,
                          .finest = 2.0,
                          .help =
                              "Light that counts: unshadowed, shadowed (no bounces) or full;\nunshadowed, "
                              "the scenes' own lights are dark"}),
    rowFor<&S::window>({.name = "window",
                        .label = "ringing suppression",
                        .greatest = 1.0,
                        .words = kWindowWords,
                        .help = "Against ringing of the light: auto or off"}),
    SettingRow{
        .name = "keys",
        .label = "key lights",
        .kind = Kind::Whole,
        .greatest = 32.0,
        .zero = "off",
        .not_a_number = "auto",
        .finest = 32.0,
        .help = "Suns and lamps at infinity that shine by shadow maps, at most: auto,\noff or a number",
        .get = [](const S& settings) { return settings.keys ? static_cast<double>(*settings.keys) : kNone; },
        .put =
            [](S& settings, double value) {
              settings.keys.reset();
              if (!std::isnan(value)) settings.keys = static_cast<std::uint32_t>(value);
            }},
    rowFor<&S::key_size>("key-size", "key shadow resolution", 256.0, 8192.0,
                         "Texels along an edge of the finest shadow map of a key light"),
    rowFor<&S::key_samples>("key-samples", "key shadow samples", 4.0, 128.0,
                            "Rays of a pixel to a key light"),
    rowFor<&S::order>("order", "SH order of the light", 1.0, sh::kMaxOrder,
                      "Bands of the light that count, at most"),
    rowFor<&S::glossy_order>("glossy-order", "SH order, glossy", 1.0, sh::kMaxOrder,
                             "Bands that glossy surfaces reflect, at most"),
    rowFor<&S::diffuse>("diffuse", "diffuse surfaces", "Light on diffuse surfaces"),
    rowFor<&S::glossy>("glossy", "glossy surfaces", "Light on glossy surfaces"),
    rowFor<&S::volumes>("volumes", "volumes", "Clouds, smoke and other media"),
    rowFor<&S::residual>("specular-environment", "sharp sky reflections",
                         "Glossy surfaces reflect what the bands of their light leave out\nof the sky",
                         "residual"),
    rowFor<&S::reflection_probes>(
        {.name = "reflection-probes",
         .label = "room reflection probes",
         .greatest = kMostProbes,
         .zero = "off",
         .finest = kMostProbes,
         .help = "Points of a room from which it is captured for the mirrors in it, at\nmost"}),
    rowFor<&S::neighborhoods>("neighborhoods", "shadows around bodies",
                              "Bodies with grids around them shade others by these, off: by\ncaptures"),
    rowFor<&S::local_shadows>("local-shadows", "local light shadows",
                              "Lights among the surfaces shine per pixel with shadow cubes, off:\nby "
                              "harmonics, or by the columns of their groups",
                              "near-shadows"),
    rowFor<&S::local_radii>(
        "local-radii", "reach of local lights", 0.0, 1000.0,
        "Lights beside a body shine per pixel, too, nearer to its middle\nthan so many of "
        "its radii; 0: only lights within its bounds",
        "near-radii"),
    rowFor<&S::patch_bounces>(
        "patch-bounces", "bounced local light",
        "Surfaces send on the light of lights among them, and of key\nlights what their bands get wrong"),
    rowFor<&S::captures>("captures", "local light updates",
                         "Bodies light and shadow each other as they stand now"),
    rowFor<&C::size>("capture-size", "update resolution", 4.0, 64.0,
                     "Texels along an edge of the cube maps in which light between\nbodies is sampled"),
    rowFor<&C::subsamples>("capture-subsamples", "update subsamples", 1.0, 16.0,
                           "Subsamples along an edge of such a texel"),
    rowFor<&S::captures_per_step>({.name = "captures-per-frame",
                                   .label = "updates per frame",
                                   .least = 1.0,
                                   .greatest = 1e6,
                                   .help = "Light probes that are drawn anew in a frame at most; a "
                                           "picture\nwithout a window is of all of them"}),
    rowFor<&S::march_step_voxels>(
        {.name = "march-step",
         .label = "volume step size",
         .least = 0.125,
         .greatest = 8.0,
         .finest = 0.125,
         .help = "Voxels that a ray through a volume goes at a step; linear\npictures take half of it"}),
    SettingRow{.name = "exposure",
               .label = "exposure",
               .kind = Kind::Real,
               .least = -64.0,
               .greatest = 64.0,
               .not_a_number = "auto",
               .help = "Stops above radiance 1 = white, or auto",
               .get =
                   [](const S& settings) {
                     return settings.exposure_ev ? static_cast<double>(*settings.exposure_ev) : kNone;
                   },
               .put =
                   [](S& settings, double value) {
                     settings.exposure_ev.reset();
                     if (!std::isnan(value)) settings.exposure_ev = static_cast<float>(value);
                   }}};

std::string rangeOf(const SettingRow& row) {
  std::string range;
  if (row.kind == Kind::Choice || row.kind == Kind::Switch) {
    static constexpr std::array<std::string_view, 2> kSwitchWords = {"off", "on"};
    const std::span<const std::string_view> words =
        row.kind == Kind::Choice ? row.words : std::span<const std::string_view>(kSwitchWords);
    for (const std::string_view word : words) range += fmt::format("{}{}", range.empty() ? "" : ", ", word);
    return "one of " + range;
  }
  range = fmt::format("{}..{}", row.least, row.greatest);
  if (!row.not_a_number.empty()) range += fmt::format(" or {}", row.not_a_number);
  return range;
}

}  // namespace

std::span<const SettingRow> settingRows() {
  return kRows;
}

const SettingRow* findSetting(std::string_view name) {
  for (const SettingRow& row : kRows)
    if (row.name == name || (!row.former.empty() && row.former == name)) return &row;
  return nullptr;
}

std::string settingWord(const SettingRow& row, const FrameSettings& settings) {
  const double value = row.get(settings);
  if (std::isnan(value)) return std::string(row.not_a_number);
  switch (row.kind) {
    case Kind::Switch:
      return value != 0.0 ? "on" : "off";
    case Kind::Choice:
      return std::string(row.words[static_cast<std::size_t>(value)]);
    case Kind::Whole:
      break;
    case Kind::Real:
      return fmt::format("{}", static_cast<float>(value));
  }
  return fmt::format("{}", static_cast<std::int64_t>(value));
}

Result<double> parseSetting(const SettingRow& row, std::string_view word) {
  const auto unknown = [&] {
    return fail("--" + std::string(row.name), fmt::format("\"{}\" is not known", word),
                "give " + rangeOf(row));
  };
  if (row.kind == Kind::Switch) {
    if (word != "on" && word != "off") return unknown();
    return word == "on" ? 1.0 : 0.0;
  }
  if (row.kind == Kind::Choice) {
    for (std::size_t i = 0; i < row.words.size(); ++i)
      if (row.words[i] == word) return static_cast<double>(i);
    return unknown();
  }
  if (!row.zero.empty() && word == row.zero) return 0.0;
  if (!row.not_a_number.empty() && word == row.not_a_number) return kNone;
  const std::optional<float> value = spec::parseNumber(word);
  if (!value) return unknown();
  return static_cast<double>(*value);
}

Result<void> putSetting(const SettingRow& row, FrameSettings& settings, double value) {
  const bool none = std::isnan(value) && !row.not_a_number.empty();
  const bool whole = row.kind == Kind::Real || value == std::floor(value);
  if (!none && !(value >= row.least && value <= row.greatest && whole))
    return fail("--" + std::string(row.name), fmt::format("{} is out of its range", value),
                "give " + rangeOf(row));
  row.put(settings, value);
  return {};
}

Result<void> putSetting(FrameSettings& settings, std::string_view name, std::string_view word) {
  const SettingRow* row = findSetting(name);
  if (row == nullptr) {
    std::string known;
    for (const SettingRow& one : kRows) known += fmt::format("{}{}", known.empty() ? "" : ", ", one.name);
    return fail(std::string(name), "is no setting of the frame", "give one of " + known);
  }
  const Result<double> value = parseSetting(*row, word);
  if (!value) return failAgain(value.error());
  return putSetting(*row, settings, *value);
}

Result<void> checkSettings(const FrameSettings& settings) {
  FrameSettings copy = settings;
  for (const SettingRow& row : kRows)
    if (Result<void> done = putSetting(row, copy, row.get(settings)); !done) return done;
  return {};
}

namespace {

constexpr std::array<std::string_view, 3> kNames = {"low", "default", "high"};
constexpr std::array<std::string_view, 3> kSettings = {"keys", "key-size", "key-samples"};

}  // namespace

std::span<const std::string_view> qualityNames() {
  return kNames;
}

std::span<const std::string_view> qualitySettings() {
  return kSettings;
}

Result<void> putQuality(FrameSettings& settings, std::string_view name) {
  const auto put = [&](std::optional<std::uint32_t> keys, std::uint32_t size, std::uint32_t samples) {
    settings.keys = keys, settings.key_size = size, settings.key_samples = samples;
    return Result<void>();
  };
  const FrameSettings plain;
  if (name == "low") return put(4, 2048, 12);
  if (name == "default") return put(plain.keys, plain.key_size, plain.key_samples);
  if (name == "high") return put(32, 8192, 64);
  return fail("quality", fmt::format("\"{}\" is not known", name), "give low, default or high");
}

Result<FrameSettings> settingsOfQuality(std::string_view name) {
  FrameSettings settings;
  if (Result<void> put = putQuality(settings, name); !put)
    return fail("--quality", put.error().problem, put.error().hint);
  return settings;
}

std::string_view qualityOf(const FrameSettings& settings) {
  for (const std::string_view name : kNames) {
    FrameSettings of_quality = settings;
    if (putQuality(of_quality, name) && of_quality == settings) return name;
  }
  return {};
}

}  // namespace lambent::frame
