// What may change between the frames of one Frame: modes, switches of effects, and the settings that trade
// accuracy for time. One table has a row for each (name, kind, range, finest value, help): command lines,
// panels and scripts go by it. Values go in and out of a row as numbers (switches 0 and 1, choices by their
// place) or as words. Setting nothing but a row's value runs nothing: Frame::setSettings does. Errors:
// names and words that are not known, values out of range.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "runtime/base/result.hpp"
#include "runtime/evaluate/transfer_table.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/sh/light_vector.hpp"
#include "runtime/sh/window.hpp"

namespace lambent::frame {

struct FrameSettings {
  evaluate::TransferMode transfer = evaluate::TransferMode::Full;
  sh::Window window = sh::Window::Off;
  // Key lights that each set of lights from infinity may have, at most; 0: none, all light goes by bands.
  // Whoever owns the environment hands it on (lighting::Environment::setMostKeys).
  std::optional<std::uint32_t> keys;  // none: as many as pay
  std::uint32_t mostKeys() const { return keys.value_or(kAutoKeys); }
  // Of shadow maps of key lights: texels along an edge of the finest, rays to a light.
  std::uint32_t key_size = 4096;
  std::uint32_t key_samples = 32;
  // Bands of the light that count, at most: higher ones are 0, as if the light had none.
  std::uint32_t order = sh::kMaxOrder;
  // Of the light that glossy surfaces weigh by their BRDF; what is left out of the sky is the residual's.
  std::uint32_t glossy_order = sh::kMaxOrder;

  // Effects. What is off is not computed, and shows nothing of its own: diffuse or glossy surfaces are black
  // but for what they give off, volumes are not there.
  bool diffuse = true, glossy = true, volumes = true;
  // Glossy surfaces reflect what the bands of their light leave out of the sky, too.
  bool residual = true;
  // Bodies with grids around them change the light of others by these; else by captures.
  bool neighborhoods = true;
  // Lights among the surfaces shine per pixel, with shadow cubes; else by harmonics.
  bool local_shadows = true;
  // So do those that stand beside a group: nearer to its middle than so many of its radii. 0: none.
  float local_radii = 6.0f;
  // And what the surfaces around them send on of their light arrives too.
  bool patch_bounces = true;
  // Bodies light and shadow each other as they stand now; else only as they were baked.
  bool captures = true;

  lighting::CaptureOptions capture{.order = 0};  // order 0: that of the groups' transfer
  std::uint32_t captures_per_step = 16;          // light probes that are drawn anew in a frame, at most
  // Of a group, at most: the others take the light of the nearest of these.
  std::uint32_t light_probes = kAllLightProbes;
  // Of rays through volumes, in voxels; linear pictures take half of it.
  float march_step_voxels = 1.0f;
  std::optional<float> exposure_ev;  // none: automatic

  static constexpr std::uint32_t kAllLightProbes = 4096;
  static constexpr std::uint32_t kAutoKeys = 16;
  bool operator==(const FrameSettings&) const = default;
};

struct SettingRow {
  enum class Kind : std::uint8_t { Switch, Choice, Whole, Real };

  std::string_view name;  // as in --name, in scripts and files
  std::string_view label;
  Kind kind = Kind::Switch;
  double least = 0.0, greatest = 1.0;         // both included; of a Choice the places of its words
  std::span<const std::string_view> words{};  // of a Choice, by place
  std::string_view zero{}, not_a_number{};    // words for 0 and NaN, where these mean something else
  std::optional<double> finest{};             // most accurate; none: no setting of accuracy
  std::string_view help{};
  double (*get)(const FrameSettings&) = nullptr;
  void (*put)(FrameSettings&, double) = nullptr;  // takes a value in range
  std::string_view former{};  // the name before 0.11, which is still understood but not shown; may be empty
};

// In the order of panels and help.
std::span<const SettingRow> settingRows();
const SettingRow* findSetting(std::string_view name);  // null: there is none

std::string settingWord(const SettingRow& row, const FrameSettings& settings);
Result<double> parseSetting(const SettingRow& row, std::string_view word);
Result<void> putSetting(const SettingRow& row, FrameSettings& settings, double value);
// By name and word, as scripts do.
Result<void> putSetting(FrameSettings& settings, std::string_view name, std::string_view word);
// Every row in its range.
Result<void> checkSettings(const FrameSettings& settings);

}  // namespace lambent::frame
