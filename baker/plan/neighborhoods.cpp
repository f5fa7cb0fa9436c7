#include "baker/plan/neighborhoods.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "baker/plan/local_light.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::baker {

void addFacing(FacingArea& sum, const glm::vec3& normal, float area) {
  FacingArea y;
  sh::evaluate(5, normal, y);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += area * y[k];
}

void addFacingAnywhere(FacingArea& sum, float area) {
  constexpr float kY0 = 0.28209479f;
  sum[0] += area * kY0;
}

namespace {

// A body changes the light noticeably up to this many half-sizes: beyond, irradiance changes by 1 % at most.
constexpr float kReach = 10.0f;
// A finely meshed receiver has a mean edge of at most this many half-sizes of the body, which is about the
// spacing of its grid.
constexpr float kFineEdge = 0.35f;
constexpr std::size_t kMostClips = 4u << 20;  // most triangles to clip over all times, for one pair of groups
constexpr std::size_t kLooks = 128;           // triangles and vertices that shadowsItself compares

struct Triangles {
  const bundle::MeshData* mesh = nullptr;  // in the frame of a node
  std::uint32_t node = 0;
  bool two_sided = false, glossy = false;
};

// Within sums up the surfaces in a body's reach.
struct Within {
  Box box;
  FacingArea facing{};
};

// A Polygon is convex and has at most 3 + 6 corners.
struct Polygon {
  std::array<glm::vec3, 9> corners;
  std::size_t count = 0;
};

// Keeps the part of the polygon where sign * (x[axis] - at) <= 0.
void clip(Polygon& polygon, int axis, float at, float sign) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const glm::vec3 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const float over_a = sign * (a[axis] - at), over_b = sign * (b[axis] - at);
    if (over_a <= 0.0f && out.count < out.corners.size()) out.corners[out.count++] = a;
    if ((over_a < 0.0f) != (over_b < 0.0f) && over_a != over_b && out.count < out.corners.size())
      out.corners[out.count++] = a + over_a / (over_a - over_b) * (b - a);
  }
  polygon = out;
}

// Adds the part of the triangle that lies in the box. `mirrored` means that its corners run the other way
// round.
void addWithin(const std::array<glm::vec3, 3>& triangle, const Triangles& of, bool mirrored, const Box& box,
               Within& sum) {
  const glm::vec3 low = glm::min(glm::min(triangle[0], triangle[1]), triangle[2]),
                  high = glm::max(glm::max(triangle[0], triangle[1]), triangle[2]);
  if (!Box{low, high}.meets(box, 0.0f)) return;
  Polygon polygon;
  for (const glm::vec3& corner : triangle) polygon.corners[polygon.count++] = corner;
  for (int axis = 0; axis < 3 && polygon.count > 0; ++axis) {
    if (high[axis] > box.high[axis]) clip(polygon, axis, box.high[axis], 1.0f);
    if (low[axis] < box.low[axis]) clip(polygon, axis, box.low[axis], -1.0f);
  }
  glm::vec3 twice(0.0f);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    sum.box.add(polygon.corners[i]);
    if (i >= 2)
      twice +=
          glm::cross(polygon.corners[i - 1] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
  }
  const float length = glm::length(twice), area = 0.5f * length;
  if (!(length > 0.0f)) return;
  const glm::vec3 normal = (mirrored ? -1.0f : 1.0f) / length * twice;
  if (of.glossy) {
    addFacingAnywhere(sum.facing, area);
  } else {
    addFacing(sum.facing, normal, area);
    if (of.two_sided) addFacing(sum.facing, -normal, area);
  }
}

class Planner {
 public:
  Planner(const Scene& scene, const std::vector<RigidGroup>& groups)
      : scene_(scene), groups_(groups), moments_(momentsOf(scene, groups)), plans_(groups.size()) {}

  std::vector<PlannedNeighborhood> plan() {
    takeRequests();
    takeVolumes();
    takeBodies();
    for (std::size_t k = 0; k < groups_.size(); ++k)
      if (plans_[k].baked) findReceivers(k);
    return std::move(plans_);
  }

 private:
  const Box& boxOf(const Moment& moment, std::size_t group) const {
    const PlacedBody& body = moment.bodies[group];
    return body.medium.empty() ? body.all : body.medium;
  }
  Box reachOf(const Moment& moment, std::size_t k) const {
    const Box& own = boxOf(moment, k);
    const float reach = kReach * own.halfSize();
    return {own.low - reach, own.high + reach};
  }

  void takeRequests() {
    for (const NeighborhoodRequest& request : scene_.neighborhoods)
      for (std::size_t k = 0; k < groups_.size(); ++k) {
        if (groups_[k].root != static_cast<std::int32_t>(request.node)) continue;
        plans_[k].baked = plans_[k].asked = true;
        plans_[k].size = request.size;
        plans_[k].extent = request.extent;
        plans_[k].reason = "asked for";
      }
  }

  void takeVolumes() {
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      if (groups_[k].volume < 0 || plans_[k].baked) continue;
      for (const Moment& moment : moments_) {
        const Box reach = reachOf(moment, k);
        for (std::size_t other = 0; other < groups_.size(); ++other)
          if (const Box& all = moment.bodies[other].all; !all.empty() && all.meets(reach, 0.0f))
            plans_[k].baked = true;
      }
      plans_[k].reason =
          plans_[k].baked ? "a volume with surfaces in its reach" : "a volume without surfaces in its reach";
    }
  }

  void takeBodies() {
    std::vector<std::pair<std::size_t, std::size_t>> found;  // a body, and the one that it moves on
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      if (groups_[k].volume >= 0 || plans_[k].baked) continue;
      if (const auto on = movesOn(k)) found.emplace_back(k, *on);
    }
    std::size_t dark = 0;
    for (const auto& [k, on] : found) dark += findGroupLights(scene_, groups_[k]).empty();
    for (const auto& [k, on] : found) {
      PlannedNeighborhood& plan = plans_[k];
      const std::string where = fmt::format("it can come within the bounds of {}", groups_[on].name);
      if (!findGroupLights(scene_, groups_[k]).empty()) {
        plan.reason =
            where + ", but gives off light, which light probes see and a neighborhood does not carry";
      } else if (dark > kMostNeighborhoods) {
        plan.reason =
            fmt::format("{}, but so can {} other bodies: light probes see them all", where, dark - 1);
      } else {
        plan.baked = true;
        plan.by_hand = movedByHand(k);
        plan.reason = where;
      }
    }
    if (dark <= kMostNeighborhoods) takeBodiesByHand(dark);
  }

  // Takes bodies that can be moved onto others by hand but stand elsewhere at rest. They must not displace
  // the grids of bodies that move about anyway.
  void takeBodiesByHand(std::size_t dark) {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < groups_.size(); ++k)
      if (plans_[k].reason.empty() && movedByHand(k) && largerThan(k) &&
          findGroupLights(scene_, groups_[k]).empty())
        found.push_back(k);
    for (const std::size_t k : found) {
      PlannedNeighborhood& plan = plans_[k];
      plan.baked = plan.by_hand = dark + found.size() <= kMostNeighborhoods;
      plan.reason = fmt::format("it can be moved by hand onto {}", groups_[*largerThan(k)].name);
      if (!plan.baked)
        plan.reason +=
            fmt::format(", but so can {} other bodies: light probes see them all", dark + found.size() - 1);
    }
  }

  // Returns whether the file says that the body may move and no animation says where.
  bool movedByHand(std::size_t k) const {
    if (groups_[k].root < 0 || groups_[k].volume >= 0) return false;
    const gltf::Node& node = scene_.nodes[static_cast<std::size_t>(groups_[k].root)];
    return node.movable && !node.animated;
  }

  // Returns a group of surfaces that is more than twice as large.
  std::optional<std::size_t> largerThan(std::size_t k) const {
    const Box& own = moments_.front().bodies[k].all;
    for (std::size_t other = 0; other < groups_.size(); ++other)
      if (const Box& all = moments_.front().bodies[other].all;
          other != k && !own.empty() && !all.empty() && muchSmaller(own, all))
        return other;
    return std::nullopt;
  }

  std::optional<std::size_t> movesOn(std::size_t k) const {
    for (const Moment& moment : moments_)
      for (std::size_t other = 0; other < groups_.size(); ++other)
        if (const Box& own = moment.bodies[k].all, &all = moment.bodies[other].all;
            other != k && !own.empty() && !all.empty() && movesAboutOn(own, all))
          return other;
    return std::nullopt;
  }

  bool glossy(const PlannedDraw& draw) const {
    const std::int32_t material = scene_.meshes[draw.mesh].primitives[draw.primitive].material;
    return material >= 0 && hasMatrices(scene_.materials[static_cast<std::size_t>(material)]);
  }

  std::vector<Triangles> trianglesOf(std::size_t group) const {
    std::vector<Triangles> out;
    const std::vector<PlannedDraw>& draws = groups_[group].draws;
    for (const PlannedDraw& draw : draws) {
      if (draw.back) continue;
      Triangles& part = out.emplace_back();
      part.mesh = &scene_.meshes[draw.mesh].primitives[draw.primitive].mesh;
      part.node = draw.node;
      part.glossy = glossy(draw);
      part.two_sided = std::any_of(draws.begin(), draws.end(), [&](const PlannedDraw& other) {
        return other.back && other.node == draw.node && other.mesh == draw.mesh &&
               other.primitive == draw.primitive;
      });
    }
    return out;
  }

  void findReceivers(std::size_t k) {
    PlannedNeighborhood& plan = plans_[k];
    Within within;  // group frame
    for (std::size_t other = 0; other < groups_.size(); ++other) {
      if (other == k || groups_[other].draws.empty()) continue;
      Within own;
      addReceiver(k, other, own);
      if (own.box.empty()) continue;
      within.box.add(own.box.low), within.box.add(own.box.high);
      for (std::size_t i = 0; i < own.facing.size(); ++i) within.facing[i] += own.facing[i];
      plan.receivers.push_back(static_cast<std::uint32_t>(other));
      if (plan.asked || groups_[k].volume >= 0)
        plan.matrices = plan.matrices || hasFineTransfer(other, boxOf(moments_.front(), k).halfSize());
    }
    if (plan.by_hand) {
      addReceiversByHand(k);
      return;
    }
    if (plan.receivers.empty()) {
      plan.baked = false;
      plan.reason += ", but no other group has surfaces in its reach";
      return;
    }
    plan.receivers_min = within.box.low;
    plan.receivers_max = within.box.high;
    plan.receivers_face = within.facing;
  }

  // Adds all groups that the body may be moved onto; their surfaces may face anywhere.
  void addReceiversByHand(std::size_t k) {
    PlannedNeighborhood& plan = plans_[k];
    const Box& own = moments_.front().bodies[k].all;
    for (std::uint32_t other = 0; other < groups_.size(); ++other)
      if (other != k && !groups_[other].draws.empty() &&
          muchSmaller(own, moments_.front().bodies[other].all) &&
          std::ranges::find(plan.receivers, other) == plan.receivers.end())
        plan.receivers.push_back(other);
    std::ranges::sort(plan.receivers);
    addFacingAnywhere(plan.receivers_face, 1.0f);
  }

  // Adds the surfaces of `other` in k's reach, at all times, in k's frame.
  void addReceiver(std::size_t k, std::size_t other, Within& sum) const {
    const RigidGroup& group = groups_[k];
    const std::vector<Triangles> parts = trianglesOf(other);
    std::size_t triangles = 1;
    for (const Triangles& part : parts) triangles += part.mesh->indices.size() / 3;
    const std::size_t stride = 1 + moments_.size() * triangles / kMostClips;
    const glm::mat4 rest_from_group =
        glm::translate(glm::mat4(1.0f), group.rest_translation) * glm::mat4_cast(group.rest_rotation);
    for (std::size_t time = 0; time < moments_.size(); time += stride) {
      const Moment& moment = moments_[time];
      if (boxOf(moment, k).empty() || moment.bodies[other].all.empty() ||
          !moment.bodies[other].all.meets(reachOf(moment, k), 0.0f))
        continue;
      glm::mat4 world_from_group = rest_from_group;
      if (group.root >= 0) {
        const auto root = static_cast<std::size_t>(group.root);
        world_from_group = moment.world[root] * glm::inverse(moments_.front().world[root]) * rest_from_group;
      }
      const glm::mat4 group_from_world = glm::inverse(world_from_group);
      Box reach;  // the body's own box at rest in its frame, and its reach around it
      const Box& box = boxOf(moments_.front(), k);
      const glm::mat4 group_from_rest = glm::inverse(rest_from_group);
      for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                           corner & 4 ? box.high.z : box.low.z);
        reach.add(glm::vec3(group_from_rest * glm::vec4(at, 1.0f)));
      }
      reach.low -= kReach * box.halfSize(), reach.high += kReach * box.halfSize();
      for (const Triangles& part : parts) {
        const glm::mat4 group_from_node = group_from_world * moment.world[part.node];
        const bool mirrored = glm::determinant(glm::mat3(group_from_node)) < 0.0f;
        eachTriangle(*part.mesh, group_from_node, [&](const std::array<glm::vec3, 3>& triangle) {
          if (std::isfinite(glm::dot(triangle[0] + triangle[1] + triangle[2], glm::vec3(1.0f))))
            addWithin(triangle, part, mirrored, reach, sum);
        });
      }
    }
  }

  // Returns whether the receiver's own transfer says more than its normals do and is about as fine as the
  // neighborhood's grid.
  bool hasFineTransfer(std::size_t other, float half_size) const {
    std::vector<std::array<glm::vec3, 3>> triangles;
    double edges = 0.0;
    bool any_glossy = false;
    for (const Triangles& part : trianglesOf(other)) {
      any_glossy = any_glossy || part.glossy;
      eachTriangle(*part.mesh, moments_.front().world[part.node],
                   [&](const std::array<glm::vec3, 3>& triangle) {
                     triangles.push_back(triangle);
                     for (std::size_t c = 0; c < 3; ++c)
                       edges += double{glm::distance(triangle[c], triangle[(c + 1) % 3])};
                   });
    }
    if (triangles.empty()) return false;
    if (any_glossy) return true;
    if (edges / (3.0 * static_cast<double>(triangles.size())) > double{kFineEdge * half_size}) return false;
    return shadowsItself(triangles);
  }

  // Returns whether some triangle faces some vertex of another.
  static bool shadowsItself(const std::vector<std::array<glm::vec3, 3>>& triangles) {
    const std::size_t stride = 1 + triangles.size() / kLooks;
    for (std::size_t a = 0; a < triangles.size(); a += stride) {
      const auto& [p, q, r] = triangles[a];
      const glm::vec3 area = glm::cross(q - p, r - p);
      const float length = glm::length(area);
      if (!(length > 0.0f)) continue;
      for (std::size_t b = 0; b < triangles.size(); b += stride) {
        const glm::vec3 to = triangles[b][0] - p;
        if (glm::dot(area, to) > 0.05f * length * glm::length(to)) return true;
      }
    }
    return false;
  }

  const Scene& scene_;
  const std::vector<RigidGroup>& groups_;
  std::vector<Moment> moments_;
  std::vector<PlannedNeighborhood> plans_;
};

}  // namespace

std::vector<PlannedNeighborhood> planNeighborhoods(const Scene& scene,
                                                   const std::vector<RigidGroup>& groups) {
  return Planner(scene, groups).plan();
}

}  // namespace lambent::baker
