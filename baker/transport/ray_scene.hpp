// The room baker/transport owns a group's geometry, samples, ray directions and surface colours, and this
// file owns visibility inside the group, by Embree. A group's geometry and the scene's materials come in;
// masks of blocked rays and first hits go out. Solid surfaces and single-sided back faces block rays, except
// flipped faces (group_geometry.hpp); alphaMode MASK blocks where its alpha says so, and alphaMode BLEND and
// panes (KHR_materials_transmission) block nothing: panesOn() finds the latter (panes.hpp). All rays of one
// sample are traced in packets of sixteen sorted directions, which was measured to be 1.2 to 2.8 times as
// fast as single rays or one direction over many samples. Calls are safe from any thread; only build() can
// fail.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "baker/transport/surface_colors.hpp"

namespace lambent::baker {

// Makes the rays of one sample, sixteen at a time, in Embree's packet layout (any type with RTCRay16's
// members). This is separate from ray_scene.cpp so that the benchmark can compare Embree's bare speed with
// ours on the same rays.

// Distributes the rays of a sample over its origins: ray r takes the origin into whose interval of the
// cumulated weights the r-th point of the golden-ratio sequence falls, so that each origin gets its share of
// every part of the sky.
class OriginDealer {
 public:
  explicit OriginDealer(std::span<const SampleOrigin> origins) : origins_(origins) {}

  std::size_t pick(std::size_t ray) const {
    if (origins_.size() == 1) return 0;
    const std::uint32_t golden =
        static_cast<std::uint32_t>(ray) * 2654435769u;  // frac(ray * (phi - 1)) * 2^32
    float left = static_cast<float>(golden >> 8) * 0x1p-24f;
    for (std::size_t o = 0; o + 1 < origins_.size(); ++o) {
      if (left < origins_[o].weight) return o;
      left -= origins_[o].weight;
    }
    return origins_.size() - 1;
  }

 private:
  std::span<const SampleOrigin> origins_;
};

inline bool isAbove(glm::vec3 direction, const SampleOrigin& origin) {
  return glm::dot(direction, origin.geometric_normal) > 0.0f;
}

// Returns the origin that a ray starts from. If the ray lies below the horizon of the origin it was given, it
// takes the next origin that it is above, so that a convex body loses nothing of its smooth normals'
// hemispheres. If there is none, the origin it was given is returned.
inline std::size_t startOf(std::size_t ray, glm::vec3 direction, std::span<const SampleOrigin> origins,
                           const OriginDealer& dealer) {
  std::size_t origin = dealer.pick(ray);
  for (std::size_t tries = 1; tries < origins.size() && !isAbove(direction, origins[origin]); ++tries)
    origin = origin + 1 == origins.size() ? 0 : origin + 1;
  return origin;
}

// This says what a direction below the horizon of its origin sees. Blocked: it starts from another origin
// that it is above, and is blocked if there is none. Mirrored: it is reflected about the origin's plane
// (docs/conventions.md, "Exit kernel"), as everywhere on the face that the origin stands for.
enum class BelowHorizon { Blocked, Mirrored };

inline glm::vec3 mirroredAbove(glm::vec3 direction, const SampleOrigin& origin) {
  const float below = glm::dot(direction, origin.geometric_normal);
  return below > 0.0f ? direction : direction - 2.0f * below * origin.geometric_normal;
}

// Says which rays of a packet are traced (-1, else 0) and which origin each starts from.
struct PacketLanes {
  alignas(64) std::array<int, kPacketWidth> valid;
  std::array<std::size_t, kPacketWidth> origin;
};

// SampleRays are the rays of one sample: the directions of a table, rotated by the sample's frame.
struct SampleRays {
  std::span<const SampleOrigin> origins;  // not empty
  glm::mat3 frame{1.0f};                  // group_from_local
  const DirectionTable& table;
  BelowHorizon below = BelowHorizon::Blocked;
};

// Fills packet p of the table. Lanes below the horizons of all origins are not valid, or mirrored.
template <typename Ray16>
void fillPacket(std::size_t p, const SampleRays& rays, const OriginDealer& dealer, Ray16& ray,
                PacketLanes& lanes) {
  const auto& [origins, frame, table, below] = rays;
  const std::size_t first = p * kPacketWidth;
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const float x = table.x[first + k], y = table.y[first + k], z = table.z[first + k];
    ray.dir_x[k] = frame[0].x * x + frame[1].x * y + frame[2].x * z;
    ray.dir_y[k] = frame[0].y * x + frame[1].y * y + frame[2].y * z;
    ray.dir_z[k] = frame[0].z * x + frame[1].z * y + frame[2].z * z;
    ray.tnear[k] = 0.0f;
    ray.tfar[k] = std::numeric_limits<float>::infinity();
    ray.time[k] = 0.0f;
    ray.mask[k] = ~0u;
    ray.flags[k] = 0;
  }
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const glm::vec3 direction(ray.dir_x[k], ray.dir_y[k], ray.dir_z[k]);
    const std::size_t origin = below == BelowHorizon::Mirrored
                                   ? dealer.pick(first + k)
                                   : startOf(first + k, direction, origins, dealer);
    const SampleOrigin& start = origins[origin];
    ray.org_x[k] = start.position.x;
    ray.org_y[k] = start.position.y;
    ray.org_z[k] = start.position.z;
    lanes.origin[k] = origin;
    lanes.valid[k] = isAbove(direction, start) ? -1 : 0;
    if (lanes.valid[k] || below == BelowHorizon::Blocked) continue;
    const glm::vec3 image = mirroredAbove(direction, start);
    ray.dir_x[k] = image.x;
    ray.dir_y[k] = image.y;
    ray.dir_z[k] = image.z;
    lanes.valid[k] = isAbove(image, start) ? -1 : 0;  // rays along the plane itself stay invalid
  }
}

// RayHit is the first hit of a table's ray: a front, or either side of a double-sided surface.
struct RayHit {
  std::uint32_t ray = 0;       // index in the table
  std::uint32_t triangle = 0;  // into GroupGeometry::triangles; of the back draw if the ray hit the back
  float u = 0.0f, v = 0.0f;    // barycentric weights of corners 1 and 2
  float distance = 0.0f;
  glm::vec3 passed{1.0f};  // what panes on the way pass of the light (panes.hpp)
};

// A RaySegment is the stretch between two points.
struct RaySegment {
  glm::vec3 origin, direction;  // the direction is unit
  float length;                 // the far end is exclusive
};

// FirstHit is the first hit of a ray that belongs to no table.
struct FirstHit {
  static constexpr std::uint32_t kNothing = 0xffffffffu;
  std::uint32_t triangle = kNothing;  // as in RayHit
  float u = 0.0f, v = 0.0f;
  float distance = std::numeric_limits<float>::infinity();
  bool back = false;  // the back of a single-sided surface, which blocks and sends no light

  bool any() const { return triangle != kNothing; }
};

// A PaneHit is where a ray passes a face of a pane.
struct PaneHit {
  std::uint32_t ray = 0;       // index in the list of rays
  std::uint32_t triangle = 0;  // as in RayHit
  float u = 0.0f, v = 0.0f, distance = 0.0f;
  bool entering = false;  // met from its front
  bool back = false;      // the back of a single-sided surface, which sends no light
};

// The shares of an origin's rays whose first hit is the back of a single-sided surface (`back`), or that or
// nearer than the origin's reach (`near`).
struct MetShares {
  float back = 0.0f, near = 0.0f;
};

// Sets bit k of masks[p] where ray 16 p + k lies below the horizons of all origins, as RayScene::trace() does
// where nothing is in the way.
void blockBelowHorizons(const SampleRays& rays, std::span<std::uint16_t> masks);

class RayScene {
 public:
  // Errors: those of decodeImage, of cut-outs; Embree cannot be set up or runs out of memory.
  static Result<RayScene> build(const GroupGeometry& geometry, const Scene& scene, DecodedImages& images);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  // Bit k of masks[p] is set where ray 16 p + k is blocked. Rays are dealt out over the origins by their
  // weights; below the horizons of all of them they are blocked untraced, or mirrored. Returns how many rays
  // were traced.
  std::uint32_t trace(const SampleRays& rays, std::span<std::uint16_t> masks) const {
    return walk(rays, /*mostly_blocked=*/false, masks, nullptr);
  }

  // Does what trace() does, and appends the hits of blocked rays to `hits`, in the order of the rays. Backs
  // of single-sided surfaces block and are not listed. `mostly_blocked` is a hint about which way is faster,
  // and must be the same if the same result is wanted.
  std::uint32_t traceHits(const SampleRays& rays, bool mostly_blocked, std::span<std::uint16_t> masks,
                          std::vector<RayHit>& hits) const {
    return walk(rays, mostly_blocked, masks, &hits);
  }

  // Sets blocked[i] to 1 if something lies between the ends of segment i, else to 0.
  void occluded(std::span<const RaySegment> segments, std::span<std::uint8_t> blocked) const;

  // Finds what each ray hits first on its stretch. This is fastest if sixteen neighbours of the list have
  // similar directions.
  void firstHits(std::span<const RaySegment> rays, std::span<FirstHit> hits) const;

  // Returns whether panes weaken any ray.
  bool hasPanes() const;
  // Finds the panes that each ray passes on its stretch, ray by ray, the nearest first.
  void panesOn(std::span<const RaySegment> rays, std::vector<PaneHit>& hits) const;

  // Fills in what the rays of each origin hit. Returns the share of all rays that hit anything.
  float meet(const SampleRays& rays, std::span<MetShares> shares) const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::uint32_t walk(const SampleRays& rays, bool mostly_blocked, std::span<std::uint16_t> masks,
                     std::vector<RayHit>* hits) const;
  std::unique_ptr<State> state_;
};

// Finds which of a sample's origins stand where they could be seen: not inside a body, and not where
// something lies on the face. Transfer from such places would leak, as darkness, over the visible parts of
// the faces. If a vertex stands inside or under something while parts of its faces can be seen, its origins
// move towards these parts: what is interpolated over the face then begins with light that is there.

// Holds a few directions that tell whether an origin lies inside something or much is in the way.
struct InsideTestTables {
  DirectionTable glance, look;
  InsideTestTables();
};

struct SeenOrigins {
  std::vector<SampleOrigin> origins;  // weights sum to 1
  bool valid = false;                 // false if no origin is seen; then `origins` holds all of them
  float blocked = 0.0f;               // share of a few rays that hit anything
  bool double_rays = false;           // much is in the way, so that twice the rays should be traced
};

// `frame` is group_from_local of the sample. `seen` is an argument so that its memory can be reused.
void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen);

}  // namespace lambent::baker
