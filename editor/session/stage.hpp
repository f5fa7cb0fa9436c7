// What is shown: the bundles' world, the light from infinity, and the frame that draws them, kept in step
// with the document. Light words are loaded when they change (a environment map that cannot be read leaves
// the light as it was), settings go to the frame. The picture lies in a texture of the frame's. Main thread,
// with a current OpenGL context. Errors: no OpenGL 4.5, what Frame::render says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/document/world_state.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/frame/frame_times.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/world/world.hpp"

namespace lambent::editor {

class Stage {
 public:
  static Result<Stage> create(std::uint64_t max_memory_bytes);

  frame::World& world() { return world_; }
  const frame::World& world() const { return world_; }
  frame::Frame& frame() { return frame_; }
  const frame::Frame& frame() const { return frame_; }
  const lighting::Environment& environment() const { return environment_; }
  ecs::Entity environmentEntity() const { return environment_entity_; }
  // The lights from infinity as they are now: what the document says, or what was there before if that
  // cannot be loaded.
  const std::vector<spec::Light>& lights() const { return lights_; }
  const std::vector<spec::Light>& fadeLights() const { return fade_lights_; }

  // Lights, edits of key lights, settings and exposure as `state` has them. Errors: words that are not known,
  // environment maps that cannot be read; all the others are followed.
  std::vector<Error> follow(const WorldState& state);
  // Fields of the EnvironmentComponent.
  void followEnvironment();

  Result<void> render(const spec::View& view, spec::Size size);
  // Whether the last frame had anything to do: then the next may, too.
  bool atRest() const { return at_rest_; }
  const frame::FrameTimes& times() const { return times_; }
  void addTime(double ms) { times_.add(ms); }

 private:
  Stage(frame::World world, lighting::Environment environment, frame::Frame frame);
  Result<void> followLights(const WorldState& state);

  frame::World world_;
  lighting::Environment environment_;
  frame::Frame frame_;
  ecs::Entity environment_entity_;
  std::vector<std::string> words_, fade_words_;
  std::vector<spec::Light> lights_, fade_lights_;
  frame::FrameTimes times_;
  bool at_rest_ = false;
};

}  // namespace lambent::editor
