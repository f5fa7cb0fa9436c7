// Surveyed scenes lie millions of metres from the origin of their world, where floats are 3 to 50 cm apart.
// Such distances are in the translations of any nodes, which may cancel each other out, or in the vertices.
// Here they go into Scene::origin. What remains is as small as the scene, at every node on the way to a
// surface, so that later stages may compute in floats.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include "baker/import/convert.hpp"
#include "baker/import/details.hpp"

namespace lambent::baker {

namespace {

using Path = gltf::AnimationChannel::Path;

// Areas are products of two lengths and their squares of four, which must neither underflow nor overflow.
// Both limits leave a factor of ten to where tracing was seen to fail.
constexpr double kLeastSide_m = 1e-8, kMostDistance_m = 1e8;

// Distances up to this many sides of the scene stay: floats there are 2^-20 of its side apart.
constexpr double kFar = 8.0;

// Returns the middle of a box in whole multiples of a power of two that is at least its side. Floats of the
// box are differences to it without rounding.
glm::dvec3 roundedCenter(const PlacedBox& box) {
  const double step = std::exp2(std::ceil(std::log2(std::max(box.side(), 1e-8))));
  return step * glm::round(box.center() / step);
}

class NearOrigin {
 public:
  NearOrigin(NodeMap map, Scene& scene)
      : map_(std::move(map)),
        scene_(scene),
        world_(sceneWorldTransforms(map_, scene)),
        shifts_(scene.nodes.size(), glm::dvec3(0.0)) {
    for (const SceneMesh& mesh : scene.meshes) boxes_.push_back(boxOf(mesh));
  }

  void run() {
    checkSizes();
    const PlacedBox all = sceneBox();
    if (all.empty() || !(all.side() > 0.0)) return;
    reach_ = kFar * all.side();
    centerMeshes();
    centerVolumes();
    const bool far = largest(all.center()) > reach_;
    if (far) scene_.origin = roundedCenter(all);
    for (const std::int32_t root : scene_.roots) shift(root, scene_.origin);
    carryNearby();
    round();
    if (far) addRoot();
  }

 private:
  gltf::Node& node(std::int32_t n) { return scene_.nodes[static_cast<std::size_t>(n)]; }
  glm::dmat4& local(std::int32_t n) { return map_.parent_from_node[static_cast<std::size_t>(n)]; }

  void checkSizes() const {
    // The farthest place of each node and those above it: if two cancel each other out, digits are lost.
    std::vector<double> farthest(world_.size());
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
      farthest[n] = largest(glm::dvec3(world_[n][3]));
      if (const std::int32_t parent = scene_.nodes[n].parent; parent >= 0)
        farthest[n] = std::max(farthest[n], farthest[static_cast<std::size_t>(parent)]);
      if (scene_.nodes[n].mesh < 0) continue;
      PlacedBox there;
      there.add(boxes_[static_cast<std::size_t>(scene_.nodes[n].mesh)], world_[n]);
      const double distance = std::max({largest(there.low), largest(there.high), farthest[n]});
      const std::string name = fmt::format("node {} (\"{}\")", n, scene_.nodes[n].name);
      if (!(distance <= kMostDistance_m))  // or not a number
        throw Error{
            {},
            fmt::format("{} reaches {:.3g} m from the origin, where floats cannot be traced", name, distance),
            fmt::format("scale or move it to within {:g} m", kMostDistance_m)};
      if (there.side() > 0.0 && there.side() < kLeastSide_m)
        throw Error{{},
                    fmt::format("{} is only {:.3g} m large, which floats cannot trace", name, there.side()),
                    fmt::format("scale it to {:g} m or more, or to 0 to hide it", kLeastSide_m)};
    }
  }

  PlacedBox sceneBox() const {
    PlacedBox all;
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
      if (scene_.nodes[n].mesh >= 0)
        all.add(boxes_[static_cast<std::size_t>(scene_.nodes[n].mesh)], world_[n]);
    for (const SceneVolume& volume : scene_.volumes)
      all.add({glm::dvec3(0.0), glm::dvec3(volume.size)},
              world_[volume.node] * glm::dmat4(volume.node_from_grid));
    return all;
  }

  bool isFar(const glm::dmat4& world, const glm::dvec3& place) const {
    return largest(glm::dmat3(world) * place) > reach_;
  }

  std::int32_t addChild(std::int32_t parent, const glm::dvec3& place) {
    const auto child = static_cast<std::int32_t>(scene_.nodes.size());
    gltf::Node added;
    added.name = node(parent).name;
    added.parent = parent;
    added.parent_from_node[3] = glm::vec4(glm::vec3(place), 1.0f);
    scene_.nodes.push_back(std::move(added));
    node(parent).children.push_back(child);
    map_.parent_from_node.push_back(glm::translate(glm::dmat4(1.0), place));
    shifts_.emplace_back(0.0);
    return child;
  }

  // A mesh whose vertices are far from its own origin is drawn by a child node in their midst.
  void centerMeshes() {
    std::vector<bool> far(scene_.meshes.size(), false);
    std::vector<glm::dvec3> center(scene_.meshes.size());
    for (std::size_t m = 0; m < center.size(); ++m) center[m] = roundedCenter(boxes_[m]);
    const auto nodes = static_cast<std::int32_t>(scene_.nodes.size());
    for (std::int32_t n = 0; n < nodes; ++n)
      if (const std::int32_t m = node(n).mesh;
          m >= 0 && isFar(world_[static_cast<std::size_t>(n)], center[static_cast<std::size_t>(m)]))
        far[static_cast<std::size_t>(m)] = true;
    for (std::int32_t n = 0; n < nodes; ++n)
      if (const std::int32_t m = node(n).mesh; m >= 0 && far[static_cast<std::size_t>(m)]) {
        const std::int32_t child = addChild(n, center[static_cast<std::size_t>(m)]);
        node(child).mesh = std::exchange(node(n).mesh, -1);
      }
    for (std::size_t m = 0; m < far.size(); ++m)
      for (ScenePrimitive& primitive : scene_.meshes[m].primitives)
        for (glm::vec3& position : primitive.mesh.positions)
          if (far[m]) position = glm::vec3(glm::dvec3(position) - center[m]);
  }

  void centerVolumes() {
    for (SceneVolume& volume : scene_.volumes) {
      PlacedBox box;
      box.add({glm::dvec3(0.0), glm::dvec3(volume.size)}, glm::dmat4(volume.node_from_grid));
      const glm::dvec3 center = roundedCenter(box);
      if (!isFar(world_[volume.node], center)) continue;
      volume.node = static_cast<std::uint32_t>(addChild(static_cast<std::int32_t>(volume.node), center));
      volume.node_from_grid[3] -= glm::vec4(glm::vec3(center), 0.0f);
    }
  }

  // Subtracts from the place of a node in its parent.
  void shift(std::int32_t n, const glm::dvec3& by) {
    local(n)[3] -= glm::dvec4(by, 0.0);
    shifts_[static_cast<std::size_t>(n)] += by;
  }

  // Returns which nodes only carry others to their places, so that no one sees where they are themselves.
  // Nodes that carry no surface are left out.
  std::vector<bool> carriers() const {
    std::vector<bool> carries(scene_.nodes.size(), false);
    const auto mark = [&](std::int32_t n) {
      for (std::int32_t at = scene_.nodes[static_cast<std::size_t>(n)].parent;
           at >= 0 && !carries[static_cast<std::size_t>(at)];
           at = scene_.nodes[static_cast<std::size_t>(at)].parent)
        carries[static_cast<std::size_t>(at)] = true;
    };
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
      if (scene_.nodes[n].mesh >= 0) mark(static_cast<std::int32_t>(n));
    for (const SceneVolume& volume : scene_.volumes) mark(static_cast<std::int32_t>(volume.node));
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
      const gltf::Node& node = scene_.nodes[n];
      if (node.mesh >= 0 || node.camera >= 0 || node.light >= 0) carries[n] = false;
    }
    for (const SceneVolume& volume : scene_.volumes) carries[volume.node] = false;
    // The place of a child turns and grows with a node that does.
    for (const gltf::Animation& animation : scene_.animations)
      for (const gltf::AnimationChannel& channel : animation.channels)
        if (channel.path != Path::Translation) carries[channel.node] = false;
    return carries;
  }

  // Moves nodes that are far from the scene into its midst, and their children as far back.
  void carryNearby() {
    constexpr double kMost = 1e30;  // that floats hold
    const std::vector<bool> carries = carriers();
    world_.resize(scene_.nodes.size());
    for (std::size_t n = 0; n < world_.size(); ++n) {
      const auto number = static_cast<std::int32_t>(n);
      const std::int32_t parent = node(number).parent;
      world_[n] = parent < 0 ? local(number) : world_[static_cast<std::size_t>(parent)] * local(number);
      const glm::dmat3 axes(world_[n]);
      if (!carries[n] || !(largest(glm::dvec3(world_[n][3])) > reach_)) continue;
      const glm::dvec3 back = glm::inverse(axes) * glm::dvec3(world_[n][3]);
      if (!(glm::length(back) <= kMost)) continue;  // its axes are flat
      shift(number, glm::dmat3(local(number)) * back);
      for (const std::int32_t child : node(number).children) shift(child, -back);
      world_[n][3] = glm::dvec4(0.0, 0.0, 0.0, 1.0);
    }
  }

  void round() {
    for (std::size_t n = 0; n < shifts_.size(); ++n) {
      if (shifts_[n] == glm::dvec3(0.0)) continue;
      gltf::Node& node = scene_.nodes[n];
      node.parent_from_node = glm::mat4(map_.parent_from_node[n]);
      if (!node.trs) continue;
      node.trs->translation = glm::vec3(node.parent_from_node[3]);
      node.parent_from_node = node.trs->matrix();
    }
    for (gltf::Animation& animation : scene_.animations)
      for (gltf::AnimationChannel& channel : animation.channels)
        if (channel.path == Path::Translation) shift(channel, shifts_[channel.node]);
  }

  static void shift(gltf::AnimationChannel& channel, const glm::dvec3& by) {
    const bool cubic = channel.interpolation == gltf::AnimationChannel::Interpolation::Cubic;
    for (std::size_t at = cubic ? 3 : 0; at < channel.values.size(); at += cubic ? 9 : 3)  // not tangents
      for (int axis = 0; axis < 3; ++axis) {
        float& value = channel.values[at + static_cast<std::size_t>(axis)];
        value = static_cast<float>(double{value} - by[axis]);
      }
  }

  void addRoot() {
    const auto root = static_cast<std::int32_t>(scene_.nodes.size());
    for (const std::int32_t child : scene_.roots) node(child).parent = root;
    gltf::Node& added = scene_.nodes.emplace_back();
    added.name = "origin";
    added.children = std::exchange(scene_.roots, {root});
  }

  NodeMap map_;
  Scene& scene_;
  std::vector<glm::dmat4> world_;
  std::vector<PlacedBox> boxes_;    // by mesh, in its own space
  std::vector<glm::dvec3> shifts_;  // by node: what was subtracted from its place
  double reach_ = 0.0;
};

}  // namespace

void placeNearOrigin(NodeMap map, Scene& scene) {
  NearOrigin(std::move(map), scene).run();
}

}  // namespace lambent::baker
