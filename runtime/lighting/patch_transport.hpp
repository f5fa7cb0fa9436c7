// Computes how light travels between the patches of a rigid group, and from them to points of its surfaces.
// Form factors are shares of rays: a patch sends cosine-distributed rays from several of its points and
// receives the radiance of the patches that they hit first (a gathering radiosity; Cohen and Greenberg 1985
// for the equations). A surface point has links, one per ray, to the regions that its rays hit. Both are made
// once; after that, bounces are sums only. All rays are fixed, so the same group gives the same numbers on
// any number of threads. Surfaces are diffuse: exit radiance is albedo times E/pi. No GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/triangle_tree.hpp"

namespace lambent::lighting {

// Owns the surfaces of a rigid group as patches that exchange light: the triangles of its patch surface
// (runtime/bundle/capture_proxy.hpp), split into smaller ones, most of them where they matter to pictures. A
// patch sends one radiance in all directions. Regions are patches, and coarser parts of the same triangles
// that contain several, like the levels of a mip map. A ray that stands for a solid angle looks up the mean
// over what it covers; otherwise a few rays or none would hit a small bright spot. Regions are numbered:
// first the patches, in their order. All positions are in the group's frame. No GL.

inline constexpr std::size_t kMaxPatches = 4096;
inline constexpr std::size_t kPatchPoints = 4;

// Names a part of a triangle whose edges are cut into `parts`. The triangle then has parts² parts, in rows of
// constant weight of the third corner; a row alternates between lower and upper triangles.
struct TrianglePart {
  std::uint32_t column = 0, row = 0;
  bool upper = false;
  // Returns the part that contains the point with weight b of the second corner and c of the third.
  static TrianglePart at(std::uint32_t parts, float b, float c);
  std::size_t place(std::uint32_t parts) const {
    return std::size_t{row} * (2 * parts - row) + 2 * std::size_t{column} + (upper ? 1 : 0);
  }
};

struct Patch {
  std::array<glm::vec3, kPatchPoints> points{};   // each represents a quarter of the area
  std::array<glm::vec3, kPatchPoints> origins{};  // start points of rays for `points`
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
  float area = 0.0f;
  glm::vec3 albedo{0.0f};
};

class Patches {
 public:
  Patches() = default;
  // Makes at least one patch per triangle, about `most` in total.
  explicit Patches(const bundle::PatchSurface& surface, std::size_t most = kMaxPatches);

  const std::vector<Patch>& all() const { return patches_; }
  std::size_t size() const { return patches_.size(); }
  // Returns the triangles that were split, in their order.
  const TriangleTree& tree() const { return tree_; }
  // Return the range of a triangle's patches, which are contiguous.
  std::size_t firstOf(std::size_t triangle) const { return levels_[triangle][0].first; }
  std::size_t countOf(std::size_t triangle) const {
    const std::uint32_t parts = levels_[triangle][0].parts;
    return std::size_t{parts} * parts;
  }
  // Returns the diagonal of the bounds, or of the part that matters to pictures.
  float extent() const { return extent_; }
  // Returns how far the patches may be from the surface that they represent.
  float error() const { return error_; }
  // Returns a point slightly above the surface from which rays may start. A point of the true surface may lie
  // a little behind the patches, or behind a wall beside them; it is then moved in front. `normal` is that of
  // the surface.
  glm::vec3 inFront(glm::vec3 point, const glm::vec3& normal) const;

  std::size_t regionCount() const { return patches_.size() + members_.size(); }
  // Returns how many levels of regions the triangle has. Level 0 holds its patches.
  std::size_t levelsOf(std::size_t triangle) const { return levels_[triangle].size(); }
  std::size_t regionAt(const RayHit& hit, std::size_t level) const;
  float areaOf(std::size_t triangle, std::size_t level) const;
  // Returns the corners of that region, drawn in a little so that rays to them do not graze its neighbours.
  std::array<glm::vec3, 3> cornersAt(const RayHit& hit, std::size_t level) const;
  // Returns a value for each region: the mean of the values of its patches.
  std::vector<glm::vec3> means(std::span<const glm::vec3> by_patch) const;

 private:
  // Each edge of a triangle is cut into `parts`, so that the level has parts² regions from `first` on.
  struct Level {
    std::uint32_t parts = 1;
    std::size_t first = 0;
  };
  void findRegions();
  // Returns how far beyond an edge of the triangle the point lies, seen along the triangle's normal; 0 over
  // it.
  float beside(std::size_t triangle, const glm::vec3& point) const;

  std::vector<Patch> patches_;
  std::vector<std::vector<Level>> levels_;           // indexed by triangle
  std::vector<std::vector<std::uint32_t>> members_;  // the patches of each coarser region
  std::vector<glm::vec3> normals_;                   // of the triangles
  TriangleTree tree_;
  float extent_ = 0.0f, error_ = 0.0f;
};

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
  // visible; a ray that hits nothing, or the back of something, gives patches().regionCount(). A point behind
  // the proxy, which sees mostly backs, takes the view of the nearest patch that faces the same way. Uses
  // several threads.
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
