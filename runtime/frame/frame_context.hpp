// What a pass sees of the frame that it runs in: the world, the light, the options, what other passes keep,
// and where to count and say why it ran. For the time of one step, or of one step and a picture.
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
  const lighting::Environment& environment;
  const FrameOptions& options;
  const spec::View* view;  // null where no picture follows
  PictureTargets& targets;
  InvalidationLog& log;
  StepCounts& counts;
  const Blackboard& board;
  // Of the pass that is asked or runs.
  const PassInfo* pass = nullptr;
  gpu::PassTimers::Scope* scope = nullptr;

  const FrameSettings& settings() const { return options.settings; }
  // Key lights whose direct light comes by shadow maps, world axes.
  std::span<const spec::Disc> keys() const {
    return options.keysApart() ? environment.keys() : std::span<const spec::Disc>();
  }
  // What the pass declares that it reads, or writes.
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
  // Says why the pass ran: those of its causes that the log has of this step, else these words.
  void because(std::string_view otherwise = {}) const;

 private:
  bool declares(std::type_index type, bool to_write) const;
};

}  // namespace lambent::frame
