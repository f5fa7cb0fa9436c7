// Draws bundles whose surfaces have no room or have not come: the finest capture proxy of each rigid group,
// every triangle in one colour, its albedo times E/pi at its normal, plus what its lamp gives now. Lit by the
// environment and by the lights that stand outside of the group, bands 0..2, without any shadow, as surfaces
// are whose transfer has not come. Comes in: the world's stand-ins, the light. Goes out: one draw into the
// bound framebuffer. Tables are made anew when others stand in; where all surfaces are here, nothing is made
// or drawn. Errors: shaders that do not compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/frame/stand_in_shared.h"
#include "runtime/frame/world.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/local_light.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::frame {

class StandIns {
 public:
  StandIns();

  // `lights`: those that stand in the scene.
  Result<void> prepare(const World& world, const lighting::Environment& environment,
                       std::span<const lighting::LocalLight> lights, const FrameSettings& settings,
                       gpu::Counters& counters);
  void draw(const spec::View& view, gpu::Counters& counters);

  // As uploaded.
  const std::vector<StandInGroup>& groups() const { return groups_; }
  const std::vector<StandInTriangle>& triangles() const { return triangles_; }

 private:
  struct Place {  // of a group, in the order of groups_
    std::uint32_t bundle = 0, group = 0;
  };
  // What the tables were made from.
  struct Seen {
    std::uint64_t stand_ins = 0, lamps = 0, local_lights = 0, transforms = 0, environment = 0;
    FrameSettings settings;
    bool operator==(const Seen&) const = default;
  };
  void collect(const World& world);
  void light(const World& world, const lighting::Environment& environment,
             std::span<const lighting::LocalLight> lights, const FrameSettings& settings);

  std::optional<gpu::Program> program_;  // from when it is first needed
  gpu::VertexArray no_vertices_;
  std::vector<Place> places_;
  std::vector<StandInGroup> groups_;
  std::vector<StandInTriangle> triangles_;
  std::optional<Seen> seen_;
  gpu::Table groups_table_, triangles_table_, view_;
};

}  // namespace lambent::frame
