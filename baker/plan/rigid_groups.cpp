#include "baker/plan/rigid_groups.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <glm/gtc/quaternion.hpp>

namespace lambent::baker {

namespace {

// Returns the rotation nearest to the upper 3x3 of a world matrix: U V^T of its SVD, made proper. Scale and
// shear stay in the group's geometry.
glm::quat polarRotation(const glm::mat4& world) {
  Eigen::Matrix3d m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m(row, column) = double{world[column][row]};
  if (!m.allFinite() || m.isZero()) return {1.0f, 0.0f, 0.0f, 0.0f};
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (rotation.determinant() < 0.0) rotation = -rotation;  // a mirror is a rotation and an inversion
  const Eigen::Quaterniond q(rotation);
  return glm::normalize(glm::quat(static_cast<float>(q.w()), static_cast<float>(q.x()),
                                  static_cast<float>(q.y()), static_cast<float>(q.z())));
}

// Returns the stretch that remains of the root's world matrix without its rotation. It is rounded to a
// millionth of each axis, so that rounding errors of a rotated or moved root do not change the keys of baked
// results.
glm::dmat3 stretchOf(const glm::mat4& world, const glm::quat& rotation) {
  constexpr int kBits = 20;
  glm::dmat3 stretch = glm::transpose(glm::mat3_cast(glm::dquat(rotation))) * glm::dmat3(glm::mat3(world));
  for (int column = 0; column < 3; ++column) {
    const double length = glm::length(stretch[column]);
    if (!(length > 0.0 && std::isfinite(length))) continue;
    const double step = std::exp2(std::ceil(std::log2(length) - 1e-3) - kBits);
    stretch[column] = glm::round(stretch[column] / step) * step + 0.0;
  }
  return stretch;
}

class GroupFinder {
 public:
  explicit GroupFinder(const Scene& scene) : scene_(scene), world_(gltf::worldTransforms(scene.nodes)) {
    groups_.emplace_back().name = "static";
  }

  std::vector<RigidGroup> find() {
    // Walks depth first without recursion, with children in order.
    std::vector<std::pair<std::int32_t, std::size_t>> stack;  // node, group
    for (auto root = scene_.roots.rbegin(); root != scene_.roots.rend(); ++root) stack.emplace_back(*root, 0);
    while (!stack.empty()) {
      const auto [index, parent_group] = stack.back();
      stack.pop_back();
      const gltf::Node& node = scene_.nodes[static_cast<std::size_t>(index)];
      const std::size_t group = startsRigidGroup(node) ? startGroup(index) : parent_group;
      if (node.mesh >= 0) addDraws(static_cast<std::uint32_t>(index), groups_[group]);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.emplace_back(*child, group);
    }
    std::erase_if(groups_, [](const RigidGroup& group) { return group.draws.empty(); });
    addVolumes();
    return std::move(groups_);
  }

 private:
  // A volume that its own node moves belongs within the group that this node starts.
  void addVolumes() {
    const auto surface_groups = static_cast<std::ptrdiff_t>(groups_.size());
    for (std::size_t v = 0; v < scene_.volumes.size(); ++v) {
      const auto node = static_cast<std::int32_t>(scene_.volumes[v].node);
      std::int32_t mover = node;
      while (mover >= 0 && !startsRigidGroup(scene_.nodes[static_cast<std::size_t>(mover)]))
        mover = scene_.nodes[static_cast<std::size_t>(mover)].parent;
      const auto end = groups_.begin() + surface_groups;
      const auto holder =
          std::find_if(groups_.begin(), end, [&](const RigidGroup& group) { return group.root == mover; });
      const auto within = holder == end ? -1 : static_cast<std::int32_t>(holder - groups_.begin());
      RigidGroup& group = groups_[startGroup(node)];
      group.volume = static_cast<std::int32_t>(v);
      group.within = within;
    }
  }

  std::size_t startGroup(std::int32_t root) {
    const gltf::Node& node = scene_.nodes[static_cast<std::size_t>(root)];
    const glm::mat4& world = world_[static_cast<std::size_t>(root)];
    RigidGroup& group = groups_.emplace_back();
    group.name = node.name.empty() ? "node " + std::to_string(root) : node.name;
    group.root = root;
    group.rest_translation = glm::vec3(world[3]);
    group.rest_rotation = polarRotation(world);
    return groups_.size() - 1;
  }

  void addDraws(std::uint32_t node, RigidGroup& group) {
    const auto mesh = static_cast<std::uint32_t>(scene_.nodes[node].mesh);
    const glm::mat4 group_from_mesh = groupFromNode(scene_, group, node, world_);
    const auto& primitives = scene_.meshes[mesh].primitives;
    for (std::uint32_t p = 0; p < primitives.size(); ++p) {
      const std::int32_t material = primitives[p].material;
      group.draws.push_back({node, mesh, p, false, group_from_mesh});
      if (material >= 0 && scene_.materials[static_cast<std::size_t>(material)].double_sided)
        group.draws.push_back({node, mesh, p, true, group_from_mesh});
    }
  }

  const Scene& scene_;
  std::vector<glm::mat4> world_;
  std::vector<RigidGroup> groups_;
};

}  // namespace

glm::mat4 groupFromNode(const Scene& scene, const RigidGroup& group, std::uint32_t node,
                        const std::vector<glm::mat4>& world) {
  if (group.root < 0) return world[node];
  glm::dmat4 root_from_node(1.0);
  for (auto at = static_cast<std::int32_t>(node); at != group.root;) {
    const gltf::Node& here = scene.nodes[static_cast<std::size_t>(at)];
    root_from_node = glm::dmat4(here.parent_from_node) * root_from_node;
    at = here.parent;
  }
  const glm::dmat4 group_from_root(
      stretchOf(world[static_cast<std::size_t>(group.root)], group.rest_rotation));
  return glm::mat4(group_from_root * root_from_node);
}

std::vector<RigidGroup> findRigidGroups(const Scene& scene) {
  return GroupFinder(scene).find();
}

}  // namespace lambent::baker
