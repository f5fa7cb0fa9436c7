// Decides how many light probes each group needs, from how near light comes to it, at rest and, if the scene
// has animations, at 64 times along them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "runtime/bundle/mesh.hpp"

namespace lambent::baker {

// Places everything in a scene at rest and along its animations: the boxes of bodies and the positions of
// lamps. The rest of the plan uses this to find out what can come near what.

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

  bool empty() const { return low.x > high.x; }
  void add(glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
  glm::vec3 centre() const { return 0.5f * low + 0.5f * high; }
  float halfSize() const { return empty() ? 0.0f : 0.5f * glm::distance(low, high); }
  float distance(glm::vec3 p) const { return glm::distance(p, glm::clamp(p, low, high)); }
  bool meets(const Box& other, float within) const {
    return glm::all(glm::lessThanEqual(low, other.high + within)) &&
           glm::all(glm::lessThanEqual(other.low, high + within));
  }
};

// Returns whether `body` is less than half as large as `other`.
bool muchSmaller(const Box& body, const Box& other);
// Returns whether `body` can move about on `other`: it is much smaller and comes within its bounds.
bool movesAboutOn(const Box& body, const Box& other);

struct PlacedBody {
  Box all, shining;  // shining: only the surfaces that give off light
  Box medium;        // the box of a volume, which has no surfaces
};

struct Lamp {
  std::uint32_t node = 0;
  std::int32_t root = -1;  // root of the group that it moves with
  float range_m = 0.0f;
  glm::vec3 place{0.0f};
};

// A Moment is the state of everything at one time, in the world's frame.
struct Moment {
  std::vector<PlacedBody> bodies;  // one per group
  std::vector<Lamp> lamps;
  std::vector<glm::mat4> world;  // world_from_node
};

// Returns the state at rest and, if there are animations, at 64 times along them.
std::vector<Moment> momentsOf(const Scene& scene, const std::vector<RigidGroup>& groups);

// Calls tell(corners) with each triangle, moved by the matrix. Vertices are moved once, since triangles share
// them.
template <typename Tell>
void eachTriangle(const bundle::MeshData& mesh, const glm::mat4& matrix, const Tell& tell) {
  std::vector<glm::vec3> moved;
  moved.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) moved.emplace_back(matrix * glm::vec4(p, 1.0f));
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    tell(std::array{moved[mesh.indices[i]], moved[mesh.indices[i + 1]], moved[mesh.indices[i + 2]]});
}

inline constexpr std::uint32_t kMostLightProbes = 32;  // the largest count that can be asked for

struct LightProbeCount {
  std::uint32_t count = 1;  // 1..kMostLightProbes; 1 means a single one for the group
  // True: the count is for the whole group, and its cells share it by area (at least one each). False: the
  // count is for each cell.
  bool of_group = true;
};

struct PlannedLightProbes {
  LightProbeCount count;
  std::string reason;  // one sentence
};

// Returns one entry per group of the list. The count follows the ratio of half the group's diagonal to the
// distance from its centre to the nearest light of another group (lamps and surfaces that give off light):
// one light probe below 0.05 (light at infinity), four below 0.15, eight below 0.25, sixteen below 0.5, else
// 32. Bodies of other groups that give off no light ask for one or four by the same ratio. A body of less
// than half the group's size that comes within its bounds asks for 32, since its shadows and reflections can
// fall anywhere. A body whose neighborhood carries its effect on the group asks for nothing. `neighborhoods`
// holds one entry per group, or is empty.
std::vector<PlannedLightProbes> planLightProbes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                                const std::vector<PlannedNeighborhood>& neighborhoods = {});

}  // namespace lambent::baker
