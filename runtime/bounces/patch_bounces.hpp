// Owns bounces by patches: what the surfaces of a rigid group reflect of lamps among them, and for key lights
// the difference to what the bands of transfer carry. It takes the world, the scene as the lighting system
// sees it, the key lights and their light at the light probes. It provides E/pi per vertex (light in bands
// 0..2 for surfaces with normal maps and for glossy ones), which the raster adds to what transfer carries,
// and the exit radiance per triangle of the group's capture proxy, which others see.
//
// When a group first needs them, form factors and links are made on worker threads, and frames go on without
// them. Open shapes, whose surfaces hardly see each other, do without patches for key lights. Unchanged light
// costs nothing: a light that moves is bounced again on the CPU (PatchRoom) and gathered on the GPU in one
// dispatch per draw. Render thread only. update() fails if a kernel does not compile on this device.
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bounces/patch_room.hpp"
#include "runtime/bounces/patch_shared.h"
#include "runtime/draws/surface_module.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct PatchBounceCounts {
  std::uint32_t rooms = 0;           // groups whose patches reflect light
  std::uint32_t patches = 0;         // in all of these groups
  std::uint32_t rooms_to_come = 0;   // groups whose form factors or links are still being made
  std::uint32_t lights_bounced = 0;  // by the last update
  std::uint32_t draws_gathered = 0;  // by the last update
};

struct PatchLights {
  std::span<const spec::Disc> keys;              // world; empty: only the bands carry their bounced light
  const lighting::GroupLights* bands = nullptr;  // the light probes' light, with keys apart
};

class PatchBounces final : public SurfaceModule {
 public:
  static constexpr std::uint32_t kNothing = 0xffffffffu;

  PatchBounces();

  // Updates all groups. If `wait` is set, waits for form factors and links. If `on` is false, frees
  // everything.
  Result<void> update(World& world, const LightPlan& plan, const PatchLights& lights, bool on, bool wait,
                      gpu::Counters& counters);

  // Returns where the light of a draw's first vertex lies, in words; kNothing if it has none.
  std::uint32_t wordOf(std::size_t draw) const { return draw < words_.size() ? words_[draw] : kNothing; }
  // Returns whether any draw has such light.
  bool any() const { return !words_.empty(); }
  bool reaches(std::size_t draw, const SurfaceDraw&) const override { return wordOf(draw) != kNothing; }
  std::uint64_t version() const override { return layout_version_; }
  void describe(std::size_t draw, SurfaceDraw& record) const override { record.bounced_word = wordOf(draw); }
  void bindFor(SurfaceReceiver receiver) const override {
    bounced_.bindStorage(isGlossy(receiver) ? kBindGlossyBounced : kBindBounced);
  }

  // Returns the radiance that the triangles of the group's capture proxy send to other groups; empty: none.
  std::span<const glm::vec3> sentBy(std::size_t group) const {
    return group < rooms_.size() ? std::span(rooms_[group].sent) : std::span<const glm::vec3>();
  }
  // Changes when sentBy() does.
  std::uint64_t versionOf(std::size_t group) const {
    return group < rooms_.size() ? rooms_[group].version : 0;
  }
  // Returns the sum of all relative changes of that radiance so far.
  double driftOf(std::size_t group) const { return group < rooms_.size() ? rooms_[group].room.drift() : 0.0; }

  const PatchBounceCounts& counts() const { return counts_; }

 private:
  struct Points {
    std::uint64_t draw = 0;  // id of the draw
    std::vector<lighting::SurfacePoint> points;
    lighting::LinkSpread spread = lighting::LinkSpread::Cosine;
  };
  struct Made {
    struct Links {
      std::uint64_t draw = 0;
      std::vector<std::uint16_t> patches;
    };
    std::shared_ptr<const lighting::PatchTransport> transport;
    std::vector<Links> links;
  };
  struct Room {  // one per group
    PatchRoom room;
    std::future<Made> coming;
    std::vector<glm::vec3> sent;
    std::uint64_t version = 0, seen = 0;  // our version, and the room's that was seen
    std::uint32_t first_patch = 0;
  };
  struct Draw {
    bool asked = false;
    gpu::Buffer links;           // null handle: not here yet
    std::uint64_t gathered = 0;  // the version of its room that was gathered
  };
  void drop();
  // States what patches do in a group.
  struct Task {
    bool apart = false;        // transfer carries bounced light of lights that are shaded per pixel
    bool mends_bands = false;  // patches correct that, because the surfaces see enough of each other
    std::uint32_t lamps = 0;   // a bit for each shadowed light that they bounce
  };
  Task taskOf(const World& world, const LightPlan& plan, const PatchLights& lights, std::size_t group) const;
  // Returns these lamps, and what stands apart if patches correct it.
  RoomLights lightsIn(const World& world, const LightPlan& plan, const PatchLights& lights,
                      std::size_t group) const;
  static std::vector<lighting::RayTriangle> othersAround(const World& world, const LightPlan& plan,
                                                         std::size_t group, const RoomLights& lights);
  void ask(World& world, std::size_t group, bool links);
  // Requests what the group needs for its lights and takes what arrived; returns whether anything did.
  bool prepare(World& world, const LightPlan& plan, const PatchLights& lights, std::size_t group, bool wait);
  // Returns whether anything arrived.
  bool take(const World& world, std::size_t group, bool wait);
  static Points pointsOf(World& world, std::size_t draw);
  bool lit(const World& world, std::size_t draw) const;
  void layOut(const World& world);
  void uploadPatches(gpu::Counters& counters);
  Result<void> gather(World& world, gpu::Counters& counters);
  Result<const gpu::Program*> program(std::uint32_t outputs);

  KeyedState<Room> rooms_;
  KeyedState<Draw> draws_;
  std::vector<std::uint32_t> words_;  // indexed by draw
  std::uint64_t layout_version_ = 0, version_ = 0;
  std::map<std::uint32_t, gpu::Program> programs_;  // keyed by outputs per vertex
  gpu::Table patches_, bounced_, directions_, block_;
  PatchBounceCounts counts_;
};

}  // namespace lambent::frame
