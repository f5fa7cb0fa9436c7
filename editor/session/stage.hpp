// Owns the lit world: the bundles' entities, the distant light, and the frame settings, all kept in step with
// the document. Light words are loaded when they change; if an environment map cannot be read, the light
// stays as it was. Main thread. With a limit in max_memory_bytes, bundles are uploaded with the first
// picture. Without a limit, and when one bundle replaces another, loading needs a current OpenGL context.
// Errors: those of lighting::Environment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/document/document.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

class Stage {
 public:
  static Result<Stage> create(std::uint64_t max_memory_bytes);

  frame::World& world() { return world_; }
  const frame::World& world() const { return world_; }
  lighting::Environment& environment() { return environment_; }
  const lighting::Environment& environment() const { return environment_; }
  ecs::Entity environmentEntity() const { return environment_entity_; }
  const frame::FrameSettings& settings() const { return settings_; }
  // Returns the distant lights: those of the document, or the previous ones if these could not be loaded.
  const std::vector<spec::Light>& lights() const { return lights_; }
  const std::vector<spec::Light>& fadeLights() const { return fade_lights_; }

  // Applies lights, edits of key lights, settings and exposure of `state`. Errors: unknown words and
  // environment maps that cannot be read; everything else is applied.
  std::vector<Error> follow(const WorldState& state);
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
