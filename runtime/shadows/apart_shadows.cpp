#include "runtime/shadows/apart_shadows.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/lighting/capture_queries.hpp"
#include "runtime/lighting/triangle_tree.hpp"

namespace lambent::frame {

namespace {

constexpr std::size_t kProxyLevel = 1;  // level of the proxies
constexpr float kLeastShare = 1e-5f;    // in radii of a body; nearer triangles are ignored

// Makes proxies on demand, placed in the world.
class Blockers {
 public:
  explicit Blockers(std::span<const bundle::CaptureProxy* const> proxies) : proxies_(proxies) {}

  const lighting::TriangleTree& of(const lighting::IncidentBody& body) {
    const auto [place, made] = trees_.try_emplace(body.key);
    if (!made || body.body.proxy >= proxies_.size()) return place->second;
    const bundle::CaptureProxy& proxy = *proxies_[body.body.proxy];
    if (proxy.levels.empty()) return place->second;
    const bundle::ProxyLevel& level = proxy.levels[std::min(kProxyLevel, proxy.levels.size() - 1)];
    std::vector<lighting::RayTriangle> triangles;
    for (std::uint32_t t = 0; t < level.triangle_count; ++t) {
      const bundle::ProxyTriangle& from = proxy.triangles[level.first_triangle + t];
      lighting::RayTriangle& triangle = triangles.emplace_back();
      triangle.front_only = from.front_only;
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corners[k] =
            glm::vec3(body.body.world_from_proxy * glm::vec4(proxy.positions[from.vertices[k]], 1.0f));
    }
    place->second = lighting::TriangleTree(std::move(triangles), kLeastShare * body.radius_m);
    return place->second;
  }

 private:
  std::span<const bundle::CaptureProxy* const> proxies_;
  std::map<std::uint64_t, lighting::TriangleTree> trees_;  // indexed by the body's key
};

// Returns whether a sphere around the body comes between the point and the light.
bool mayHide(const lighting::IncidentBody& body, const lighting::LocalLight& light, const glm::vec3& point) {
  const glm::vec3 way = light.position_ws - point, to_body = body.center_ws - point;
  const float squared = glm::dot(way, way);
  const float along = squared > 0.0f ? std::clamp(glm::dot(way, to_body) / squared, 0.0f, 1.0f) : 0.0f;
  return glm::distance(to_body, along * way) < body.radius_m + light.extent_m();
}

// Returns the share of the light that the bodies let through.
float shareThrough(std::span<const lighting::IncidentBody* const> bodies, Blockers& blockers,
                   const lighting::LocalLight& light, const glm::vec3& point) {
  const std::optional<lighting::LightQuery> query = lighting::queryOf(light, point);
  if (!query) return 1.0f;
  const std::vector<glm::vec3> directions = lighting::capture::discDirections(*query);
  if (directions.empty()) return 1.0f;
  std::vector<bool> hidden(directions.size(), false);
  for (const lighting::IncidentBody* body : bodies) {
    const lighting::TriangleTree& tree = blockers.of(*body);
    for (std::size_t i = 0; i < directions.size(); ++i)
      hidden[i] = hidden[i] || tree.blocked(point, query->distance_m * directions[i], 1.0f);
  }
  const auto count = std::ranges::count(hidden, false);
  return static_cast<float>(count) / static_cast<float>(directions.size());
}

}  // namespace

void hideApart(LitScene& scene, std::span<const bundle::CaptureProxy* const> proxies) {
  Blockers blockers(proxies);
  for (lighting::IncidentGroup& group : scene.groups) {
    group.open.clear();
    if (group.left_out.empty() || std::ranges::all_of(group.apart, [](float share) { return share == 0.0f; }))
      continue;
    group.open.assign(group.samples_ws.size() * scene.lights.size(), 1.0f);
    for (std::size_t s = 0; s < group.samples_ws.size(); ++s)
      for (std::size_t k = 0; k < scene.lights.size(); ++k) {
        if (group.apart[k] == 0.0f) continue;
        std::vector<const lighting::IncidentBody*> bodies;
        for (const std::uint32_t body : group.left_out)
          if (mayHide(scene.bodies[body], scene.lights[k], group.samples_ws[s]))
            bodies.push_back(&scene.bodies[body]);
        if (!bodies.empty())
          group.open[s * scene.lights.size() + k] =
              shareThrough(bodies, blockers, scene.lights[k], group.samples_ws[s]);
      }
  }
}

}  // namespace lambent::frame
