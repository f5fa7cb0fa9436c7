// Computes how light travels between the patches of a rigid group, and from them to points of its surfaces.
// Form factors are shares of rays: a patch sends cosine-distributed rays from several of its points and
// receives the radiance of the patches that they hit first (a gathering radiosity; Cohen and Greenberg 1985
// for the equations). A surface point has links, one per ray, to the regions that its rays hit. Both are made
// once; after that, bounces are sums only. All rays are fixed, so the same group gives the same numbers on
// any number of threads. Surfaces are diffuse: exit radiance is albedo times E/pi. No GL.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/patches.hpp"

namespace lambent::lighting {

inline constexpr std::size_t kLinks = 64;  // links per point

// States how the directions of links are distributed about the normal.
enum class LinkSpread : std::uint8_t {
  Cosine,     // E/pi is the mean over the links
  Hemisphere  // uniform over the hemisphere, for light as harmonics
};

// Returns the directions in the frame of linkFrame(), z along the normal.
const std::array<glm::vec3, kLinks>& linkDirections(LinkSpread spread);

struct LinkFrame {
  glm::vec3 x, y, z;
  glm::vec3 turned(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};
// Builds a frame from the normal alone (Duff and others 2017), as patch_gather.comp does. Its sign switches
// at a height of the normal that walls do not have, so that rounding changes nothing.
inline constexpr float kFrameTurnsOver = -0.37f;
LinkFrame linkFrame(const glm::vec3& normal);

struct SurfacePoint {
  glm::vec3 position{0.0f};  // in the group's frame
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
};

class PatchTransport {
 public:
  PatchTransport() = default;
  // Makes patches and form factors on several threads. `order` is the number of bands of distant light that
  // direct() accepts.
  explicit PatchTransport(const bundle::CaptureProxy& proxy, std::size_t most = kMaxPatches, int order = 5);

  const Patches& patches() const { return patches_; }
  const PatchRegions& regions() const { return regions_; }
  int order() const { return order_; }

  // Returns the exit radiance of each patch when `direct` (E/pi, possibly below 0) falls on it: direct light
  // and what arrives from the other patches, times albedo. Stops when the next bounce would add less than 1 /
  // 10 000.
  std::vector<glm::vec3> bounce(std::span<const glm::vec3> direct) const;

  // Returns E/pi at a patch directly from distant light, given by order² coefficients: the transfer vector
  // without bounces, made with the same rays as the form factors (Sloan 2002, eq. 4).
  glm::vec3 direct(std::size_t patch, std::span<const glm::vec4> light) const;

  // Returns how much E/pi bounces add when 1 falls directly on every patch, averaged over patches, which
  // count alike in pictures: a room on a wide ground is a room. It is 0 for an open shape.
  float bounced() const { return bounced_; }

  // Returns kLinks regions for each point. Each region is about as large as its ray stands for and is wholly
  // visible; a ray that hits nothing, or the back of something, gives regions().size(). A point behind the
  // proxy, which sees mostly backs, takes the view of the nearest patch that faces the same way. Uses several
  // threads.
  std::vector<std::uint16_t> link(std::span<const SurfacePoint> points, LinkSpread spread) const;

  // Returns the mean exit radiance of each triangle of all levels of the proxy, given that of the patches.
  // Triangles that are not the patches' own take that of the patches near them.
  std::vector<glm::vec3> byTriangle(std::span<const glm::vec3> given_off) const;

 private:
  struct Share {
    std::uint32_t patch = 0;
    float share = 0.0f;  // share of the rays
  };
  void findShares();
  float meanBounced() const;
  // Returns the region of a link whose ray stands for this solid angle and starts where `rays` does.
  std::size_t regionFrom(const glm::vec3& origin, const RayHit& hit, float solid_angle_sr) const;
  // Returns a place from which the rays of a point behind the proxy may start.
  glm::vec3 startNear(const SurfacePoint& point) const;
  void findNearest(const bundle::CaptureProxy& proxy);

  Patches patches_;
  PatchRegions regions_;
  int order_ = 5;
  float bounced_ = 0.0f;
  std::vector<float> transfer_;             // order² per patch
  std::vector<Share> shares_;               // all shares, ordered by patch
  std::vector<std::uint32_t> first_share_;  // for each patch, with the end as last entry
  std::size_t own_triangles_ = 0;           // of the finest level, if that is the surface of the patches
  // Holds, for each further triangle of all levels, four nearby patches.
  std::vector<std::array<std::uint32_t, kPatchPoints>> nearest_;
};

}  // namespace lambent::lighting
