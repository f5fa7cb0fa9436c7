// Owns the lit world: the bundles' entities, the light from infinity, and the settings by which a frame draws
// them, kept in step with the document. Light words are loaded when they change; an environment map that
// cannot be read leaves the light as it was. Main thread. Where max_memory_bytes limits them, bundles go
// to the GPU with the first picture; without a limit, and when one takes another's place, they need a current
// OpenGL context at once. Errors: those of lighting::Environment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/document/world_state.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

class Stage {
 public:
  static Result<Stage> create(std::uint64_t max_memory_bytes);

  frame::World& world() { return world_; }
  const frame::World& world() const { return world_; }
  const lighting::Environment& environment() const { return environment_; }
  ecs::Entity environmentEntity() const { return environment_entity_; }
  const frame::FrameSettings& settings() const { return settings_; }
  // The lights from infinity as they are now: what the document says, or what was there before if that
  // cannot be loaded.
  const std::vector<spec::Light>& lights() const { return lights_; }
  const std::vector<spec::Light>& fadeLights() const { return fade_lights_; }

  // Takes lights, edits of key lights, settings and exposure from `state`. Errors: words that are not known,
  // environment maps that cannot be read; all the others are followed.
  std::vector<Error> follow(const WorldState& state);
  // Takes turn, fade and intensity from the environment's entity.
  void followEnvironment();

 private:
  Stage(frame::World world, lighting::Environment environment);
  Result<void> followLights(const WorldState& state);

  frame::World world_;
  lighting::Environment environment_;
  frame::FrameSettings settings_;
  ecs::Entity environment_entity_;
  std::vector<std::string> words_, fade_words_;
  std::vector<spec::Light> lights_, fade_lights_;
};

}  // namespace lambent::editor
