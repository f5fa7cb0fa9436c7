// Turns the command line of lambent-demo into values. parseOptions() takes argv and returns Options, with
// every word parsed and in range, or the exit code to stop with: 0 after --help and --version, 2 after one
// line on stderr that says what is wrong and what to do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runtime/debug/overlay_options.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/surface/views.hpp"

namespace lambent::demo {

struct Options {
  std::vector<std::filesystem::path> bundles;
  std::vector<spec::Light> lights;
  std::vector<std::string> light_words;  // as given, for reports
  std::vector<spec::Light> fade_lights;  // a second set of lights from infinity
  std::vector<std::string> fade_words;
  std::vector<spec::KeyEdit> key_edits;
  float fade = 0.0f;                   // share of fade_lights, 0..1
  bool default_light = false;          // no light was given
  std::optional<spec::Camera> camera;  // nothing: the file's first camera, else an orbit
  spec::Size size;
  std::optional<std::filesystem::path> headless;  // .png or .exr
  bool linear = false;                            // `headless` is an .exr file
  frame::FrameSettings settings;                  // one option per row of their table
  frame::ViewChoice view;
  frame::OverlayOptions overlays;
  std::uint32_t frames = 1;
  float rotate_light_deg = 0.0f;
  std::optional<float> time_s;  // of the scenes' animations in the last frame; nothing: at rest
  float step_s = 0.0333f;       // time between frames
  float lamps = 1.0f;           // factor on the strength of the scenes' own lights
  std::uint64_t max_memory_bytes = ~std::uint64_t{0};  // GPU memory for the bundles
  bool json = false;
};

std::variant<Options, int> parseOptions(int argc, const char* const* argv);

// Writes the line to stderr that precedes exit code 1 or 2.
void printError(const Error& error);

}  // namespace lambent::demo
