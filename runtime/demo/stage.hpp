// Owns what both ways of running show: the bundles as a world, the lights of the command line as entities in
// it, and the environment. Fails if an environment map or a bundle cannot be opened.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/gpu/context.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/surface/views.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

// The command line of lambent-demo as values. parseOptions() takes argv and returns Options, with
// every word parsed and in range, or the exit code to stop with: 0 after --help and --version, 2 after one
// line on stderr that says what is wrong and what to do.
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

// Limits how far the wheel moves the camera of lambent-demo.
inline constexpr float kZoomPerNotch = 0.9f;
// Farther away a scene is a dot, and nearer its centre there is nothing to look at.
inline constexpr float kFarthestRadii = 12.0f, kNearestRadii = 0.05f;
// The camera keeps this distance from the surface in front of it.
inline constexpr float kGapRadii = 0.03f;

// Returns the distance to the scene's centre after so many notches of the wheel. Distances are in radii of
// the scene; surface: from the camera to the surface in the middle of the picture, if there is one.
inline float zoomed(float distance, float notches, std::optional<float> surface) {
  const float wanted = std::clamp(distance * std::pow(kZoomPerNotch, notches), kNearestRadii,
                                  std::max(kFarthestRadii, distance));
  if (notches <= 0.0f || !surface) return wanted;
  return std::max(wanted, std::min(distance, distance - *surface + kGapRadii));
}

// Loads the lights. This comes first, so that a wrong file is reported before a device is needed. Reports on
// stderr what was repaired in the environment maps.
Result<lighting::Environment> loadEnvironment(const Options& options);

class Stage {
 public:
  // Opens the bundles, which load while frames are rendered, and chooses the view: the requested camera, else
  // the file's first one, else an orbit that frames the scene. Needs a GL context. Fails if there is no
  // camera of that name.
  static Result<Stage> create(const Options& options, lighting::Environment environment);

  frame::World& world() { return world_; }
  lighting::Environment& environment() { return environment_; }

  Result<spec::View> view(float aspect) const;
  // Moves the camera as the mouse did. A camera of the file stays as it is until the first drag, and then
  // becomes the orbit at the same place that looks at the scene's centre. surface_m: from the camera to the
  // surface in the middle of the picture, through which the wheel does not move it.
  void move(const gpu::Input& input, std::optional<float> surface_m = {});
  // Moves the first light that stands in the scene, in the plane of the picture, by fractions of the
  // picture's height; right and down are positive. Does nothing if there is none.
  void dragLight(const spec::View& view, float right, float down);

 private:
  struct FileCamera {
    std::size_t bundle = 0;
    std::uint32_t node = 0;
  };
  Stage(const Options& options, lighting::Environment environment);
  Result<void> chooseView(const std::optional<spec::Camera>& camera, float aspect);
  // Return the file's camera that shows the scene, and where it stands.
  const gltf::Camera& fileCamera() const;
  glm::mat4 worldFromCamera() const;

  frame::World world_;
  lighting::Environment environment_;
  scene::Box bounds_;  // of the scene at rest, so that moving objects do not move the camera
  std::optional<FileCamera> file_camera_, first_file_camera_;
  spec::OrbitCamera orbit_, first_orbit_;
};

// Runs lambent-demo in one of two ways. Headless, it loads everything, renders, writes the picture whole or
// not at all, and prints its path (or the report). Windowed, it shows the scene while it loads, under a light
// that turns, until it is closed.
Result<void> runHeadless(const Options& options);
Result<void> runWindowed(const Options& options);

}  // namespace lambent::demo
