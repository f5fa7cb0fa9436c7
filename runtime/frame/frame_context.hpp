// Describes the frame that a pass runs in: the world, the light, the options, what other passes keep, and
// where the pass counts and says why it ran. It lives for one step, or one step and a picture.
#pragma once

#include <cassert>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/frame/blackboard.hpp"
#include "runtime/frame/frame_options.hpp"
#include "runtime/frame/invalidation_log.hpp"
#include "runtime/frame/picture_targets.hpp"
#include "runtime/frame/step_counts.hpp"
#include "runtime/gpu/pass_timers.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct PassInfo;

struct FrameContext {
  World& world;
  lighting::Environment& environment;  // only the pass for transforms changes it: its suns of the scene
  const FrameOptions& options;
  const spec::View* view;  // null if no picture follows
  PictureTargets& targets;
  InvalidationLog& log;
  StepCounts& counts;
  const Blackboard& board;
  // These belong to the pass that is asked or runs.
  const PassInfo* pass = nullptr;
  gpu::PassTimers::Scope* scope = nullptr;

  const FrameSettings& settings() const { return options.settings; }
  // Returns the key lights whose direct light comes by shadow maps, in world axes.
  std::span<const spec::Disc> keys() const {
    return options.keysApart() ? environment.keys() : std::span<const spec::Disc>();
  }
  // Return what the pass declares that it reads, or writes.
  template <class Type>
  const Type& read() const {
    assert(declares(typeid(Type), /*to_write=*/false));
    return board.get<Type>();
  }
  template <class Type>
  Type& write() const {
    assert(declares(typeid(Type), /*to_write=*/true));
    return board.get<Type>();
  }
  gpu::Counters& counters() const { return scope->counters(); }
  void count(std::string_view name, std::uint64_t value) const { counts.add(name, value); }
  // Says why the pass ran: states those of its causes that the log has for this step or, if there are none,
  // `otherwise`.
  void because(std::string_view otherwise = {}) const;

 private:
  bool declares(std::type_index type, bool to_write) const;
};

}  // namespace lambent::frame
