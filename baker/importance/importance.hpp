// The room baker/importance says how much each part of a rigid group's surfaces matters to pictures: how much
// of them it takes up, seen directly by eyes, and how much light it sends to what they see (the
// adjoint of one bounce; Smits, Arvo and Salesin 1992). Whatever chooses what is worth work weighs by it. The
// group as rays see it comes in; a field over its surfaces and the points that eyes see go out. It takes a
// second at most, runs on all threads, does not depend on how many, and has no errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "baker/transport/ray_scene.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

// Places eyes: points from which pictures of a rigid group are likely to be taken. Half of all pictures are
// those of the file's cameras; the other half is taken from the connected free space in which these stand.
// Without cameras, eyes stand in the rooms of the group, around the whole of it, and around its parts, so
// that small bodies are seen from near by, too.

struct Eye {
  enum class View : std::uint8_t { AllAround, Cone, Frustum };

  glm::vec3 position{0.0f};  // as GroupGeometry::positions
  float weight = 0.0f;       // the share of all pictures that are taken from here
  View view = View::AllAround;
  glm::mat3 axes{1.0f};                      // right, up and backward
  float tangent_x = 0.0f, tangent_y = 0.0f;  // of half the angle of a frustum
  float cone_cosine = -1.0f;                 // of half the angle of a cone

  // Returns the unit direction of ray i of a low-discrepancy sequence that covers the view.
  glm::vec3 direction(std::size_t i) const;
  // Returns the rays per steradian around a unit direction, for one ray in all; 0 outside the view.
  float density(const glm::vec3& direction) const;
};

// Returns the file's cameras as eyes of the group at rest.
std::vector<Eye> cameraEyes(const Scene& scene, const RigidGroup& group, const GroupGeometry& geometry);

// Adds the cameras' eyes to the key of a result that depends on them.
void addEyes(std::span<const Eye> eyes, KeyMaker& key);

// Returns all eyes that see anything; their weights sum to 1. `cameras` are those of cameraEyes().
std::vector<Eye> placeEyes(const GroupGeometry& geometry, const RayScene& rays, std::vector<Eye> cameras);

// Returns the i-th number of van der Corput in this base, 0..1.
float radicalInverse(std::size_t i, std::size_t base);

// Divides what eyes see into regions that take up about as much of all pictures, so that errors are bounded
// in each part of what is seen and not only on average.

class Regions {
 public:
  Regions() = default;
  // Points that count alike are divided in halves along the longest axis, `depth` times.
  Regions(std::vector<glm::vec3> points, int depth);

  std::size_t size() const { return std::size_t{1} << depth_; }
  std::size_t at(const glm::vec3& position) const;

 private:
  struct Cut {
    int axis = 0;
    float at = 0.0f;
  };
  std::vector<Cut> cuts_;  // a complete binary tree; the children of cut i are 2 i + 1 and 2 i + 2
  int depth_ = 0;
};

// Returns the 95th percentile of errors of regions; `weights` are what the regions count, and those without
// any are left out.
double boundingError(std::span<const double> errors, std::span<const double> weights);

// A SeenPoint is a point of a front face that an eye sees.
struct SeenPoint {
  FirstHit hit;
  glm::vec3 position{0.0f}, normal{0.0f};  // the normal is the face's
  glm::vec3 to_eye{0.0f};                  // unit
  std::uint32_t eye = 0, ray = 0;          // the ray by which it is seen, counted over all eyes
  float share = 0.0f;                      // of all pictures; the shares of all points sum to 1
};

// A Place is where importance is asked for, a little off the face.
struct Place {
  glm::vec3 position{0.0f}, normal{0.0f};
};

// Both are shares of all pictures per square metre.
struct ImportanceAt {
  float seen = 0.0f;  // taken up by the surface itself
  float sent = 0.0f;  // lit by what a white surface there sends on
};

struct SampleImportance {
  // The share of all pictures in which each sample counts: what is seen of the faces around it, and a part of
  // what is lit by them, whose errors average out. 0: nobody sees anything of it.
  std::vector<float> shares;
  std::vector<std::uint32_t> regions;  // in which each sample lies
  std::size_t region_count = 1;
  float extent = 0.0f;  // Importance::extent()

  // Returns whether the sample counts at least a little beside the mean.
  bool matters(std::size_t sample) const {
    constexpr float kLeast = 0.02f;
    return shares[sample] * static_cast<float>(shares.size()) >= kLeast;
  }
};

class Importance {
 public:
  // Nothing matters where no eye sees anything.
  Importance() = default;
  // `rays` are those of the geometry, and must outlive this.
  Importance(const GroupGeometry& geometry, const RayScene& rays, std::vector<Eye> cameras);

  const std::vector<Eye>& eyes() const { return eyes_; }
  // Returns what eyes see of the geometry, or of the same surfaces cut into other triangles, by about `count`
  // rays, in their order.
  std::vector<SeenPoint> look(std::size_t count, const GroupGeometry& geometry, const RayScene& rays) const;
  // Divides what eyes see into parts that count alike.
  const Regions& regions() const { return regions_; }
  // Returns the diagonal of the box that holds nearly all of what eyes see, m.
  float extent() const { return extent_; }
  // Returns the middle of that box.
  const glm::vec3& middle() const { return middle_; }

  ImportanceAt at(const Place& place) const;
  // Returns a bound on what at() finds to be seen, without rays.
  float mostSeen(const Place& place) const;

  SampleImportance ofSamples(const SampleSet& samples) const;

 private:
  struct Sender {  // a seen point that gathers light
    Place place;
    float share = 0.0f;
    float area = 0.0f;  // for which it stands, m^2
  };
  float densityAt(const Eye& eye, const Place& place, glm::vec3& way) const;

  const GroupGeometry* geometry_ = nullptr;
  const RayScene* rays_ = nullptr;
  std::vector<Eye> eyes_;
  std::vector<float> seen_shares_;  // of each eye's view, that shows fronts
  std::vector<Sender> senders_;
  Regions regions_;
  float extent_ = 0.0f;
  glm::vec3 middle_{0.0f};
};

}  // namespace lambent::baker
