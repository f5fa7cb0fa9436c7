// How light goes between the patches of a rigid group, and from them to the points of its surfaces. Form
// factors are shares of rays: a patch sends rays, distributed as the cosine, from several of its points and
// receives what the patches give off that they meet first (a gathering radiosity; Cohen and Greenberg 1985
// for the equations). Points of surfaces have links, one for each of their rays: the patch that it meets.
// Both are made once; then light is bounced by sums alone. All rays are fixed, so the same group gives the
// same numbers on any number of threads. Radiance of diffuse surfaces: what leaves is albedo times E/pi. No
// GL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/patch_regions.hpp"
#include "runtime/lighting/patches.hpp"

namespace lambent::lighting {

inline constexpr std::size_t kLinks = 64;  // of a point

// How the directions of links are distributed about the normal.
enum class LinkSpread : std::uint8_t {
  Cosine,     // E/pi is the mean of what they bring
  Hemisphere  // all directions alike: for light as harmonics
};

// In the frame of linkFrame(): z along the normal.
const std::array<glm::vec3, kLinks>& linkDirections(LinkSpread spread);

struct LinkFrame {
  glm::vec3 x, y, z;
  glm::vec3 turned(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};
// By the normal alone (Duff and others 2017); patch_gather.comp has the same. It turns over at a height that
// walls do not have, so that rounding changes nothing.
inline constexpr float kFrameTurnsOver = -0.37f;
LinkFrame linkFrame(const glm::vec3& normal);

struct SurfacePoint {
  glm::vec3 position{0.0f};  // group frame
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
};

class PatchTransport {
 public:
  PatchTransport() = default;
  // order: bands of light from infinity that direct() knows. Works on several threads.
  explicit PatchTransport(const bundle::CaptureProxy& proxy, std::size_t most = kMaxPatches, int order = 5);

  const Patches& patches() const { return patches_; }
  const PatchRegions& regions() const { return regions_; }
  int order() const { return order_; }

  // What each patch gives off when `direct` (E/pi, also below 0) falls on it: that, and what it receives from
  // the others, times its albedo; until the next bounce would add less than 1 / 10 000.
  std::vector<glm::vec3> bounce(std::span<const glm::vec3> direct) const;
  std::vector<glm::vec3> bounce(std::span<const float> direct) const;

  // E/pi at a patch straight from light at infinity of which order² coefficients are known: the transfer
  // vector without bounces, by the same rays as the form factors (Sloan 2002, eq. 4).
  glm::vec3 direct(std::size_t patch, std::span<const glm::vec4> light) const;

  // What bounces add where 1 falls on every patch straight: the mean over their area. An open shape has 0.
  float bounced() const { return bounced_; }

  // kLinks regions to each point, each about as large as its ray stands for and wholly in sight; one that
  // meets nothing, or the back of something, has regions().size(). A point that lies behind the proxy, so
  // that it sees backs for the most part, takes the view of the nearest patch that faces alike. On several
  // threads.
  std::vector<std::uint16_t> link(std::span<const SurfacePoint> points, LinkSpread spread) const;

  // Of each triangle of all levels of the proxy, the mean of what its patches give off. Those of coarser
  // levels have that of the patches near them.
  std::vector<glm::vec3> byTriangle(std::span<const glm::vec3> given_off) const;

  std::uint64_t bytes() const;

 private:
  struct Share {
    std::uint32_t patch = 0;
    float share = 0.0f;  // of the rays
  };
  void findShares();
  float meanBounced() const;
  // What a link goes to whose ray, from where `rays` start, stands for this solid angle.
  std::size_t regionFrom(const glm::vec3& origin, const RayHit& hit, float solid_angle_sr,
                         const RaysFrom& rays) const;
  // Where the rays of a point behind the proxy may start.
  glm::vec3 startNear(const SurfacePoint& point) const;
  void findNearest(const bundle::CaptureProxy& proxy);

  Patches patches_;
  PatchRegions regions_;
  int order_ = 5;
  float bounced_ = 0.0f;
  std::vector<float> transfer_;             // order² for each patch
  std::vector<Share> shares_;               // patch after patch
  std::vector<std::uint32_t> first_share_;  // of each patch, and the end
  // Of the triangles of coarser levels, four patches each.
  std::vector<std::array<std::uint32_t, kPatchPoints>> nearest_;
};

}  // namespace lambent::lighting
