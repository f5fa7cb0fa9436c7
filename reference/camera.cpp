#include "reference/camera.hpp"

#include <limits>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

namespace lambent::baker::reference {

namespace {

struct Box {
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
  void add(const glm::vec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void add(const Box& box, const glm::mat4& matrix) {
    for (int corner = 0; corner < 8; ++corner)
      add(glm::vec3(matrix * glm::vec4((corner & 1) ? box.max.x : box.min.x,
                                       (corner & 2) ? box.max.y : box.min.y,
                                       (corner & 4) ? box.max.z : box.min.z, 1.0f)));
  }
};

// Returns the union of the boxes of primitives and volumes, transformed by their nodes, as in the runtime
// (runtime/scene/bounds.hpp). It is not the tightest box, but any reader gets it from the file's min and max.
Box boundsOf(const Scene& scene, const std::vector<gltf::Node>& nodes) {
  Box all;
  const std::vector<glm::mat4> world = gltf::worldTransforms(nodes);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].mesh < 0) continue;
    for (const ScenePrimitive& primitive : scene.meshes[static_cast<std::size_t>(nodes[n].mesh)].primitives) {
      Box box;
      for (const glm::vec3& position : primitive.mesh.positions) box.add(position);
      all.add(box, world[n]);
    }
  }
  for (const SceneVolume& volume : scene.volumes)
    all.add({.min = glm::vec3(0.0f), .max = glm::vec3(volume.size)},
            world[volume.node] * volume.node_from_grid);
  return all;
}

// Returns the summed area vectors of single-sided surfaces; double-sided ones have no open side.
glm::vec3 openSide(const Surfaces& surfaces) {
  glm::dvec3 sum(0.0);
  for (const Surface& surface : surfaces.surfaces())
    for (std::uint32_t t = 0; !surface.material.double_sided && t < surface.triangle_count; ++t)
      sum += 0.5 * surfaces.areaVector(surface.first_triangle + t);
  return glm::vec3(sum);
}

}  // namespace

Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces,
                          const std::vector<gltf::Node>& nodes_at_rest,
                          const std::optional<spec::Camera>& camera, float aspect) {
  const Box bounds = boundsOf(scene, nodes_at_rest);
  if (camera && std::holds_alternative<spec::OrbitCamera>(*camera))
    return spec::orbitView(std::get<spec::OrbitCamera>(*camera), bounds.min, bounds.max, aspect);
  std::optional<std::size_t> node;
  if (camera) {
    const auto found = spec::findCameraNode(scene.nodes, scene.cameras, std::get<spec::NamedCamera>(*camera));
    if (!found) return failAgain(found.error());
    node = *found;
  } else {
    for (std::size_t n = 0; n < scene.nodes.size() && !node; ++n)
      if (scene.nodes[n].camera >= 0) node = n;
  }
  if (!node)
    return spec::orbitView(spec::framingOrbit(bounds.min, bounds.max, openSide(surfaces), aspect), bounds.min,
                           bounds.max, aspect);
  return spec::cameraView(scene.cameras[static_cast<std::size_t>(scene.nodes[*node].camera)],
                          gltf::worldTransforms(scene.nodes)[*node], bounds.min, bounds.max, aspect);
}

EyeRays::EyeRays(const spec::View& view, const spec::Size& size)
    : world_from_clip_(glm::inverse(glm::dmat4(view.clip_from_view) * glm::dmat4(view.view_from_world))),
      view_from_world_(view.view_from_world),
      size_(size),
      pixel_angle_rad_(2.0f / (view.clip_from_view[1][1] * static_cast<float>(size.height))) {}

Ray EyeRays::through(std::uint32_t x, std::uint32_t y) const {
  const double clip_x = 2.0 * (x + 0.5) / size_.width - 1.0, clip_y = 1.0 - 2.0 * (y + 0.5) / size_.height;
  const glm::dvec4 near = world_from_clip_ * glm::dvec4(clip_x, clip_y, -1.0, 1.0);
  const glm::dvec4 far = world_from_clip_ * glm::dvec4(clip_x, clip_y, 1.0, 1.0);
  const glm::dvec3 begin = glm::dvec3(near) / near.w, end = glm::dvec3(far) / far.w;
  return {.origin = glm::vec3(begin), .dir = glm::vec3(end - begin), .far = 1.0f};
}

double EyeRays::depthOf(const glm::dvec3& point_ws) const {
  return -(view_from_world_ * glm::dvec4(point_ws, 1.0)).z;
}

}  // namespace lambent::baker::reference
