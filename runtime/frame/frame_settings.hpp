// Holds what may change between the frames of one Frame: modes, switches of effects, and settings that trade
// accuracy for time. A table has a row for each setting (name, kind, range, finest value, help), from which
// command lines, panels and scripts are made. Values are set and read through a row as numbers (0 and 1 for
// switches, indices for choices) or as words. Setting a value through a row has no effect on a Frame until
// Frame::setSettings(). Unknown names and words, and values out of range, are returned as an Error.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "runtime/base/result.hpp"
#include "runtime/evaluate/samples.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/window.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::frame {

struct FrameSettings {
  evaluate::TransferMode transfer = evaluate::TransferMode::Full;
  sh::Window window = sh::Window::Off;
  // Limits the number of key lights of each set of lights at infinity; 0: none, so bands carry all light.
  // The owner of the environment passes it on (lighting::Environment::setMostKeys).
  std::optional<std::uint32_t> keys;  // nothing: kAutoKeys, of which only useful ones are made
  std::uint32_t mostKeys() const { return keys.value_or(kAutoKeys); }
  // Shadow maps of key lights have this many texels along an edge of the finest map, and trace this many
  // rays.
  std::uint32_t key_size = 4096;
  std::uint32_t key_samples = 32;
  // Limits the number of bands of the light. Higher bands are 0.
  std::uint32_t order = sh::kMaxOrder;
  // Limits the bands that glossy surfaces weigh by their BRDF. `residual` shows the rest of the
  // sky.
  std::uint32_t glossy_order = sh::kMaxOrder;

  // Effects that are off are not computed and not shown: diffuse or glossy surfaces are black except for
  // their emission, and volumes are absent.
  bool diffuse = true, glossy = true, volumes = true;
  // Glossy surfaces also reflect what the bands of their light leave out of the sky.
  bool residual = true;
  // Mirrors in rooms show the room as captured from this many points of it, at most; 0: the sky where they
  // see it, and a mean elsewhere.
  std::uint32_t reflection_probes = 1;
  // Bodies with grids change the light of others by these; if false, by captures.
  bool neighborhoods = true;
  // Lights among the surfaces shine per pixel, with shadow cubes; if false, by harmonics.
  bool local_shadows = true;
  // This also holds for lights beside a group, nearer to its centre than this many of its radii; 0: none.
  float local_radii = 6.0f;
  // The light of these is also bounced by the surfaces around them.
  bool patch_bounces = true;
  // Bodies light and shadow each other as they stand now; if false, only as they were baked.
  bool captures = true;

  lighting::CaptureOptions capture{};    // its order is that of the groups' transfer, whatever stands here
  std::uint32_t captures_per_step = 16;  // largest number of light probes captured per frame
  // Sets the step of rays through volumes, in voxels; linear pictures use half of it.
  float march_step_voxels = 1.0f;
  std::optional<float> exposure_ev;  // stops; nothing: automatic

  static constexpr std::uint32_t kAutoKeys = 16;
  bool operator==(const FrameSettings&) const = default;
};

struct SettingRow {
  enum class Kind : std::uint8_t { Switch, Choice, Whole, Real };

  std::string_view name;  // as in --name, scripts and files
  std::string_view label;
  Kind kind = Kind::Switch;
  double least = 0.0, greatest = 1.0;         // both included; indices of words for a Choice
  std::span<const std::string_view> words{};  // words of a Choice, in order
  std::string_view zero{}, not_a_number{};  // words for the values 0 and NaN, if these have a special meaning
  std::optional<double> finest{};           // most accurate value; nothing: does not affect accuracy
  std::string_view help{};
  double (*get)(const FrameSettings&) = nullptr;
  void (*put)(FrameSettings&, double) = nullptr;  // takes a value in range
  std::string_view former{};  // the name before 0.11, which is still understood but not shown; may be empty
};

// Returns the rows in the order of panels and help.
std::span<const SettingRow> settingRows();
const SettingRow* findSetting(std::string_view name);  // null if there is none

std::string settingWord(const SettingRow& row, const FrameSettings& settings);
Result<double> parseSetting(const SettingRow& row, std::string_view word);
Result<void> putSetting(const SettingRow& row, FrameSettings& settings, double value);
// Sets a value by name and word, as scripts do.
Result<void> putSetting(FrameSettings& settings, std::string_view name, std::string_view word);
// Fails if any value is out of its row's range.
Result<void> checkSettings(const FrameSettings& settings);

// Defines named sets of settings that trade accuracy of pictures for raster time: low for weak devices, high
// for the most accurate pictures. Settings that a set does not name stay as they are. docs/accuracy.md says
// what each costs and how it looks. Unknown names are returned as an Error.

// Returns the names that --quality takes: low, default, high.
std::span<const std::string_view> qualityNames();
// Returns the names of the rows of settingRows() that a quality sets.
std::span<const std::string_view> qualitySettings();

Result<void> putQuality(FrameSettings& settings, std::string_view name);
Result<FrameSettings> settingsOfQuality(std::string_view name);
// Returns the quality with these values of its settings, or an empty name if there is none.
std::string_view qualityOf(const FrameSettings& settings);

// Describes how a frame is made: the picture's size and kind, settings, upload budget, and what it shows
// besides light.

enum class Output {
  Linear,  // for comparisons: float RGBA, one ray per pixel centre, textures at full resolution
  Display  // tone-mapped, sRGB-coded, four samples per pixel
};

// Tells where pictures go.
enum class Destination {
  Picture,  // the frame's own target, which can be read back
  Window,   // framebuffer 0
  Shared    // linear radiance into textures of another program's code (Frame::share), on top of what is there
};

struct FrameOptions {
  spec::Size size;
  Output output = Output::Display;
  Destination destination = Destination::Picture;
  bool show_sky = true;  // false: nothing is drawn where no surface is
  FrameSettings settings{};
  std::uint64_t upload_budget_bytes = std::uint64_t{16} << 20;  // most bytes per frame; less if it took long
  // If true, captures arrive in the next frame, however long that takes, so that every run gives the same
  // pictures.
  bool wait_for_captures = false;
  ViewChoice view{};
  OverlayOptions overlays{};

  bool linear() const { return output == Output::Linear; }
  // Returns whether direct light of key lights comes by shadow maps. Unshadowed light does not need them.
  bool keysApart() const { return settings.transfer != evaluate::TransferMode::Unshadowed; }
};

}  // namespace lambent::frame
