// Owns what both ways of running show: the bundles as a world, the lights of the command line as entities in
// it, and the environment that follows its entity. Fails if an environment map or a bundle cannot be opened.
#pragma once

#include "runtime/base/result.hpp"
#include "runtime/demo/options.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

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
