#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/light_plan/light_plan.hpp"
#include "runtime/lighting/capture_queries.hpp"
#include "runtime/lighting/triangle_tree.hpp"

namespace lambent::frame {

namespace {

constexpr float kLeastShare = 1e-5f;  // in radii of a body; nearer triangles are ignored

// Makes proxies on demand, placed in the world.
class Blockers {
 public:
  explicit Blockers(std::span<const bundle::CaptureProxy* const> proxies) : proxies_(proxies) {}

  const lighting::TriangleTree& of(const lighting::IncidentBody& body) {
    const auto [place, made] = trees_.try_emplace(body.key);
    if (!made || body.body.proxy >= proxies_.size()) return place->second;
    std::vector<lighting::RayTriangle> triangles;
    lighting::appendBlockers(*proxies_[body.body.proxy], body.body.world_from_proxy, triangles);
    if (triangles.empty()) return place->second;
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

std::size_t ApartOcclusion::update(LightPlan& plan, std::span<const bundle::CaptureProxy* const> proxies,
                                   std::uint64_t version) {
  Inputs inputs{
      .version = version, .groups = std::vector<Group>(plan.groups.size()), .lights = {}, .bodies = {}};
  bool any = false;
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const lighting::IncidentGroup& group = plan.groups[g];
    const auto apart = [](const lighting::LightCarrier& carrier) { return carrier.apart() > 0.0f; };
    if (group.left_out.empty() || std::ranges::none_of(group.carriers, apart)) continue;
    inputs.groups[g] = {group.samples_ws, group.carriers, group.left_out};
    any = true;
  }
  if (any) {
    inputs.lights = plan.lights;
    for (lighting::LocalLight& light : inputs.lights) light.power = {};
    for (const lighting::IncidentBody& body : plan.bodies)
      inputs.bodies.push_back(body.body.world_from_proxy);
  }
  std::size_t probes = 0;
  if (open_.size() != plan.groups.size() || inputs != traced_) {
    open_.assign(plan.groups.size(), {});
    Blockers blockers(proxies);
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
      const Group& group = inputs.groups[g];
      probes += group.samples_ws.size();
      for (const glm::vec3& sample : group.samples_ws)
        for (std::size_t k = 0; k < plan.lights.size(); ++k) {
          std::vector<const lighting::IncidentBody*> bodies;
          if (group.carriers[k].apart() > 0.0f)
            for (const std::uint32_t body : group.left_out)
              if (mayHide(plan.bodies[body], plan.lights[k], sample)) bodies.push_back(&plan.bodies[body]);
          open_[g].push_back(bodies.empty() ? 1.0f : shareThrough(bodies, blockers, plan.lights[k], sample));
        }
    }
    traced_ = std::move(inputs);
  }
  for (std::size_t g = 0; g < plan.groups.size(); ++g) plan.groups[g].open = open_[g];
  return probes;
}

}  // namespace lambent::frame
