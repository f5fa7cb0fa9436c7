// What both ways of running show: the bundles as a world, the lights of the command line as entities in it,
// and the environment that follows its entity. Errors: those of opening environment maps and bundles.
#pragma once

#include "runtime/base/result.hpp"
#include "runtime/demo/options.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::demo {

// Lights first: a wrong file is told before a device is looked for. Says on stderr what was repaired in them.
Result<lighting::Environment> loadEnvironment(const Options& options);

class Stage {
 public:
  // Needs a GL context. Opens the bundles, which load while frames are rendered.
  static Result<Stage> create(const Options& options, lighting::Environment environment);

  frame::World& world() { return world_; }
  const lighting::Environment& environment() const { return environment_; }

  void turnLight(float degrees);
  // The environment as its entity says.
  void applyEnvironment();
  // Moves the first light that stands in the scene in the plane of the picture, by fractions of its height:
  // right and down are positive. Does nothing where there is none.
  void dragLight(const spec::View& view, float right, float down);

 private:
  Stage(const Options& options, lighting::Environment environment);

  frame::World world_;
  lighting::Environment environment_;
  ecs::Entity environment_entity_;
};

}  // namespace lambent::demo
