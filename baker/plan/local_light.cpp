#include "baker/plan/local_light.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "runtime/bundle/gltf_types.hpp"

namespace lambent::baker {

namespace {

constexpr std::size_t kTimes = 64;
constexpr float kTouch = 1e-3f;  // share of the larger body's half-size
// A body can move about on another only if the ratio of their half-sizes is below this.
constexpr float kMuchSmaller = 0.5f;

// Returns the points of a mesh that lie farthest in 26 directions. However they are turned, their box is
// close to that of the mesh.
std::vector<glm::vec3> outerPoints(const bundle::MeshData& mesh) {
  std::vector<glm::vec3> out;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if ((x == 0 && y == 0 && z == 0) || mesh.positions.empty()) continue;
        const glm::vec3 direction(x, y, z);
        out.push_back(*std::max_element(
            mesh.positions.begin(), mesh.positions.end(),
            [&](glm::vec3 a, glm::vec3 b) { return glm::dot(a, direction) < glm::dot(b, direction); }));
      }
  return out;
}

}  // namespace

bool muchSmaller(const Box& body, const Box& other) {
  return body.halfSize() < kMuchSmaller * other.halfSize();
}

bool movesAboutOn(const Box& body, const Box& other) {
  return muchSmaller(body, other) && body.meets(other, kTouch * other.halfSize());
}

std::vector<Moment> momentsOf(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::vector<std::vector<std::vector<glm::vec3>>> points;  // by mesh and primitive
  for (const SceneMesh& mesh : scene.meshes) {
    auto& of_mesh = points.emplace_back();
    for (const ScenePrimitive& primitive : mesh.primitives) of_mesh.push_back(outerPoints(primitive.mesh));
  }
  std::vector<std::set<std::int32_t>> shining(groups.size());  // emissive materials, by group
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const PlannedLight& light : findGroupLights(scene, groups[g]))
      if (light.kind == PlannedLight::Kind::Material)
        shining[g].insert(static_cast<std::int32_t>(light.index));
  float duration_s = 0.0f;
  for (const gltf::Animation& animation : scene.animations)
    duration_s = std::max(duration_s, gltf::durationOf(animation));

  std::vector<Moment> moments(scene.animations.empty() ? 1 : 1 + kTimes);
  for (std::size_t time = 0; time < moments.size(); ++time) {
    Moment& moment = moments[time];
    std::vector<gltf::Node> nodes = scene.nodes;
    if (time > 0)
      gltf::applyAnimations(scene.animations,
                            duration_s * static_cast<float>(time - 1) / static_cast<float>(kTimes - 1),
                            nodes);
    moment.world = gltf::worldTransforms(nodes);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      PlacedBody& body = moment.bodies.emplace_back();
      if (groups[g].volume >= 0) {
        const SceneVolume& volume = scene.volumes[static_cast<std::size_t>(groups[g].volume)];
        const glm::mat4 placed = moment.world[volume.node] * volume.node_from_grid;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::vec3 at = glm::vec3(volume.size) * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2);
          body.medium.add(glm::vec3(placed * glm::vec4(at, 1.0f)));
        }
      }
      for (const PlannedDraw& draw : groups[g].draws) {
        const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
        const bool shines = shining[g].contains(material);
        for (const glm::vec3& p : points[draw.mesh][draw.primitive]) {
          const glm::vec3 placed(moment.world[draw.node] * glm::vec4(p, 1.0f));
          body.all.add(placed);
          if (shines) body.shining.add(placed);
        }
      }
    }
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].light < 0) continue;
      const gltf::Light& light = scene.lights[static_cast<std::size_t>(nodes[n].light)];
      const glm::vec3 power = light.intensity * light.color;
      if (light.type == gltf::Light::Type::Directional || !(glm::dot(power, power) > 0.0f)) continue;
      moment.lamps.push_back({n, groupRootOf(scene, n), light.range_m, glm::vec3(moment.world[n][3])});
    }
  }
  return moments;
}

namespace {

constexpr std::uint32_t kOfBodies = 4;  // most light probes that a body without light of its own asks for

struct Step {
  float ratio;
  std::uint32_t count;
};
// These counts leave an error of about 5 % of the picture between light probes
// (docs/design/captures.md, "Light probes near a lamp").
constexpr std::array kSteps = {Step{0.05f, 1}, Step{0.15f, 4}, Step{0.25f, 8}, Step{0.5f, 16}};

std::uint32_t countFor(float ratio) {
  for (const Step& step : kSteps)
    if (ratio < step.ratio) return step.count;
  return kMostLightProbes;
}

// Keeps the largest request, and of several equal ones the first.
class Choice {
 public:
  void ask(std::uint32_t count, auto reason) {
    if (count > chosen_.count.count) chosen_ = {{count, true}, reason()};
  }
  PlannedLightProbes take() { return std::move(chosen_); }

 private:
  PlannedLightProbes chosen_{{1, true}, "light comes from far away: nothing of other groups is near"};
};

// NaN and zero sizes ask for nothing.
float ratioOf(float half_size, float distance) {
  if (!(half_size > 0.0f)) return 0.0f;
  return distance > 0.0f ? half_size / distance : std::numeric_limits<float>::max();
}

std::string ratioText(const std::string& what, float ratio) {
  if (ratio > 1.0f) return fmt::format("{} comes as near as its own size", what);
  return fmt::format("half its size over the distance to {} is up to {:.2f}", what, ratio);
}

}  // namespace

std::vector<PlannedLightProbes> planLightProbes(const Scene& scene, const std::vector<RigidGroup>& groups,
                                                const std::vector<PlannedNeighborhood>& neighborhoods) {
  std::vector<Choice> choices(groups.size());
  for (const Moment& moment : momentsOf(scene, groups)) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Box& own = moment.bodies[g].all;
      const float half = own.halfSize();
      if (own.empty()) continue;
      const auto askBy = [&](float distance, std::uint32_t most, const std::string& what) {
        const float ratio = ratioOf(half, distance);
        choices[g].ask(std::min(countFor(ratio), most), [&] { return ratioText(what, ratio); });
      };
      for (const Lamp& lamp : moment.lamps) {
        const float distance = glm::distance(lamp.place, own.centre());
        if (lamp.root == groups[g].root || (lamp.range_m > 0.0f && distance > lamp.range_m + half)) continue;
        const std::string& name = scene.nodes[lamp.node].name;
        askBy(distance, kMostLightProbes,
              name.empty() ? fmt::format("the light of node {}", lamp.node) : "the light of " + name);
      }
      for (std::size_t other = 0; other < groups.size(); ++other) {
        const PlacedBody& body = moment.bodies[other];
        if (other == g || body.all.empty()) continue;
        if (!body.shining.empty())
          askBy(body.shining.distance(own.centre()), kMostLightProbes,
                "what shines of " + groups[other].name);
        // Light probes do not sample what neighborhoods carry.
        if (other < neighborhoods.size() && neighborhoods[other].carries(g)) continue;
        if (movesAboutOn(body.all, own))
          choices[g].ask(kMostLightProbes,
                         [&] { return groups[other].name + " can come within its bounds"; });
        askBy(body.all.distance(own.centre()), kOfBodies, groups[other].name);
      }
    }
  }
  std::vector<PlannedLightProbes> out;
  for (Choice& choice : choices) out.push_back(choice.take());
  return out;
}

}  // namespace lambent::baker
