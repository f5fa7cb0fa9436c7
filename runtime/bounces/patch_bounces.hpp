// Bounces by patches: what the surfaces of a rigid group send on of lamps among them, and of key lights what
// the bands of transfer get wrong. Comes in: the world, the scene as the lighting system sees it, the key
// lights and what the light probes have of them. Goes out: per vertex E/pi (of surfaces with normal maps and
// glossy ones light of bands 0..2), which the raster adds to what transfer brings, and per triangle of the
// group's capture proxy what others see of it. When a group first needs them, form factors and links are made
// on worker threads; the frames go on without them until they are there. Open shapes, whose surfaces hardly
// see each other, have none for key lights. What changes nothing costs nothing: a light that moves is bounced
// anew on the CPU (PatchRoom) and gathered on the GPU, one dispatch for each draw. Errors: a kernel that does
// not compile on this device.
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "runtime/base/keyed_state.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bounces/patch_room.hpp"
#include "runtime/bounces/patch_shared.h"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/shadows/lit_scene.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

struct PatchBounceCounts {
  std::uint32_t rooms = 0;           // groups whose patches send on light
  std::uint32_t patches = 0;         // of all of them
  std::uint32_t rooms_to_come = 0;   // whose form factors or links are being made
  std::uint32_t lights_bounced = 0;  // in the last update
  std::uint32_t draws_gathered = 0;  // likewise
};

struct PatchLights {
  std::span<const spec::Disc> keys;              // world; none: their bounced light is left to the bands
  const lighting::GroupLights* bands = nullptr;  // in which the keys stand apart
};

class PatchBounces {
 public:
  static constexpr std::uint32_t kNothing = 0xffffffffu;

  PatchBounces();

  // wait: for form factors and links, rather than going on without them. Without `on` it holds nothing.
  Result<void> update(World& world, const LitScene& scene, const PatchLights& lights, bool on, bool wait,
                      gpu::Counters& counters);

  // Where the light of a draw's first vertex lies, in words; kNothing: it has none.
  std::uint32_t wordOf(std::size_t draw) const { return draw < words_.size() ? words_[draw] : kNothing; }
  // Whether it holds anything.
  bool any() const { return !words_.empty(); }
  // Rises when any word changes.
  std::uint64_t layoutVersion() const { return layout_version_; }
  void bindStorage(std::uint32_t binding) const { bounced_.bindStorage(binding); }

  // What the triangles of the group's capture proxy send on, for others to see; empty: nothing.
  std::span<const glm::vec3> sentBy(std::size_t group) const {
    return group < rooms_.size() ? std::span(rooms_[group].sent) : std::span<const glm::vec3>();
  }
  // Another number when that changed.
  std::uint64_t versionOf(std::size_t group) const {
    return group < rooms_.size() ? rooms_[group].version : 0;
  }
  // By how much of itself it has changed so far, summed up.
  double driftOf(std::size_t group) const { return group < rooms_.size() ? rooms_[group].room.drift() : 0.0; }

  const PatchBounceCounts& counts() const { return counts_; }
  std::uint64_t bytesResident() const;

 private:
  struct Points {
    std::uint64_t draw = 0;  // its id
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
  struct Room {  // by group
    PatchRoom room;
    std::future<Made> coming;
    std::vector<glm::vec3> sent;
    std::uint64_t version = 0, seen = 0;  // ours, and the room's
    std::uint32_t first_patch = 0;
  };
  struct Draw {
    bool asked = false;
    gpu::Buffer links;           // empty handle: not here yet
    std::uint64_t gathered = 0;  // the version of its room
  };
  void drop();
  // Local lights, a bit each, within the group's bounds, and others that shine on it per pixel.
  static std::uint32_t within(const LitScene& scene, std::size_t group);
  static std::uint32_t beside(const LitScene& scene, std::size_t group);
  // Whether transfer brings bounced light of lights that shine per pixel: key lights, and lamps beside.
  static bool apart(const World& world, const LitScene& scene, const PatchLights& lights, std::size_t group);
  // Lamps that shine on the group, and what stands apart if its surfaces see enough of each other.
  RoomLights lightsIn(const World& world, const LitScene& scene, const PatchLights& lights,
                      std::size_t group) const;
  static std::vector<lighting::RayTriangle> othersAround(const World& world, const LitScene& scene,
                                                         std::size_t group, const RoomLights& lights);
  void ask(World& world, std::size_t group, bool links);
  // Asks for what the group needs of its lights and takes what came. Whether anything did.
  bool prepare(World& world, const LitScene& scene, const PatchLights& lights, std::size_t group, bool wait);
  // Whether anything came.
  bool take(const World& world, std::size_t group, bool wait);
  static Points pointsOf(World& world, std::size_t draw);
  bool lit(const World& world, std::size_t draw) const;
  void layOut(const World& world);
  void uploadPatches(gpu::Counters& counters);
  Result<void> gather(World& world, gpu::Counters& counters);
  Result<const gpu::Program*> program(std::uint32_t outputs);

  KeyedState<Room> rooms_;
  KeyedState<Draw> draws_;
  std::vector<std::uint32_t> words_;  // by draw
  std::uint64_t layout_version_ = 0, version_ = 0;
  std::map<std::uint32_t, gpu::Program> programs_;  // by outputs
  gpu::Table patches_, bounced_, directions_, block_;
  PatchBounceCounts counts_;
};

}  // namespace lambent::frame
