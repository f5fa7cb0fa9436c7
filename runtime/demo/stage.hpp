// Owns what both ways of running show: the bundles as a world, the lights of the command line as entities in
// it, and the environment that follows its entity. Fails if an environment map or a bundle cannot be opened.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/demo/options.hpp"
#include "runtime/gpu/window.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

// Owns the view of lambent-demo: the requested camera, else the file's first one, else an orbit. In the
// window the mouse moves the orbit. A camera of the file stays as it is until the first drag, and then
// becomes the orbit at the same place that looks at the scene's centre.

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

class ViewController {
 public:
  // `aspect` is that of the picture, for an orbit that frames the scene. Fails if there is no camera of that
  // name.
  static Result<ViewController> create(const frame::World& world, const std::optional<spec::Camera>& camera,
                                       float aspect);

  Result<spec::View> view(const frame::World& world, float aspect) const;
  // surface_m: from the camera to the surface in the middle of the picture, through which the wheel does not
  // move it.
  void move(const frame::World& world, const gpu::Input& input, std::optional<float> surface_m = {});

 private:
  struct FileCamera {
    std::size_t bundle = 0;
    std::uint32_t node = 0;
  };
  scene::Box bounds_;  // of the scene at rest, so that moving objects do not move the camera
  std::optional<FileCamera> file_camera_, first_file_camera_;
  spec::OrbitCamera orbit_, first_orbit_;
};

// Loads the lights. This comes first, so that a wrong file is reported before a device is needed. Reports on
// stderr what was repaired in the environment maps.
Result<lighting::Environment> loadEnvironment(const Options& options);

class Stage {
 public:
  // Opens the bundles, which load while frames are rendered. Needs a GL context.
  static Result<Stage> create(const Options& options, lighting::Environment environment);

  frame::World& world() { return world_; }
  lighting::Environment& environment() { return environment_; }

  void turnLight(float degrees);
  // Updates the environment from its entity.
  void applyEnvironment();
  // Moves the first light that stands in the scene, in the plane of the picture, by fractions of the
  // picture's height; right and down are positive. Does nothing if there is none.
  void dragLight(const spec::View& view, float right, float down);

 private:
  Stage(const Options& options, lighting::Environment environment);

  frame::World world_;
  lighting::Environment environment_;
  ecs::Entity environment_entity_;
};

// Runs lambent-demo in one of two ways. Headless, it loads everything, renders, writes the picture whole or
// not at all, and prints its path (or the report). Windowed, it shows the scene while it loads, under a light
// that turns, until it is closed.
Result<void> runHeadless(const Options& options);
Result<void> runWindowed(const Options& options);

}  // namespace lambent::demo
