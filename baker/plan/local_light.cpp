#include "baker/plan/local_light.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/plan/group_lights.hpp"
#include "runtime/bundle/keyframes.hpp"

namespace lambent::baker {

namespace {

constexpr int kTimes = 64;
constexpr float kTouch = 1e-3f;         // of the larger body's half-size
constexpr float kMuchSmaller = 0.5f;    // half-size of a body that can move about on another
constexpr std::uint32_t kOfBodies = 4;  // light samples that bodies which only reflect ask for

struct Step {
  float ratio;
  std::uint32_t count;
};
// So that about 5 % of the picture are left to the places between light samples (docs/accuracy.md, "Near
// lights").
constexpr std::array kSteps = {Step{0.05f, 1}, Step{0.15f, 4}, Step{0.25f, 8}, Step{0.5f, 16}};

std::uint32_t countFor(float ratio) {
  for (const Step& step : kSteps)
    if (ratio < step.ratio) return step.count;
  return kMostLightSamples;
}

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

// The points of a mesh that lie farthest in 26 directions: turned as one likes, its box is near theirs.
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

struct Body {
  Box all, shining;  // shining: surfaces that give off light
};

struct Lamp {
  std::uint32_t node = 0;
  std::int32_t root = -1;  // of the group that it moves with
  float range_m = 0.0f;
  glm::vec3 place{0.0f};
};

// Everything at one time.
struct Moment {
  std::vector<Body> bodies;  // as the groups
  std::vector<Lamp> lamps;
};

class Motion {
 public:
  Motion(const Scene& scene, const std::vector<RigidGroup>& groups) : scene_(scene), groups_(groups) {
    for (const SceneMesh& mesh : scene.meshes) {
      auto& points = points_.emplace_back();
      for (const ScenePrimitive& primitive : mesh.primitives) points.push_back(outerPoints(primitive.mesh));
    }
    for (const RigidGroup& group : groups) {
      auto& shining = shining_.emplace_back();
      for (const PlannedLight& light : findGroupLights(scene, group))
        if (light.kind == PlannedLight::Kind::Material)
          shining.insert(static_cast<std::int32_t>(light.index));
    }
    for (const gltf::Animation& animation : scene.animations)
      duration_s_ = std::max(duration_s_, gltf::durationOf(animation));
  }

  int times() const { return scene_.animations.empty() ? 1 : 1 + kTimes; }

  // 0: at rest, then along the animations.
  Moment at(int time) const {
    std::vector<gltf::Node> nodes = scene_.nodes;
    if (time > 0)
      gltf::applyAnimations(scene_.animations, duration_s_ * static_cast<float>(time - 1) / float{kTimes - 1},
                            nodes);
    const std::vector<glm::mat4> world = gltf::worldTransforms(nodes);
    Moment moment;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      Body& body = moment.bodies.emplace_back();
      for (const PlannedDraw& draw : groups_[g].draws) {
        const std::int32_t material = scene_.meshes[draw.mesh].primitives[draw.primitive].material;
        const bool shines = shining_[g].contains(material);
        for (const glm::vec3& p : points_[draw.mesh][draw.primitive]) {
          const glm::vec3 placed(world[draw.node] * glm::vec4(p, 1.0f));
          body.all.add(placed);
          if (shines) body.shining.add(placed);
        }
      }
    }
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].light < 0) continue;
      const gltf::Light& light = scene_.lights[static_cast<std::size_t>(nodes[n].light)];
      const glm::vec3 power = light.intensity * light.color;
      if (light.type == gltf::Light::Type::Directional || !(glm::dot(power, power) > 0.0f)) continue;
      moment.lamps.push_back({n, groupRootOf(scene_, n), light.range_m, glm::vec3(world[n][3])});
    }
    return moment;
  }

  std::string lampName(const Lamp& lamp) const {
    const std::string& name = scene_.nodes[lamp.node].name;
    return name.empty() ? fmt::format("the light of node {}", lamp.node) : "the light of " + name;
  }

 private:
  const Scene& scene_;
  const std::vector<RigidGroup>& groups_;
  std::vector<std::vector<std::vector<glm::vec3>>> points_;  // mesh, primitive
  std::vector<std::set<std::int32_t>> shining_;              // materials, by group
  float duration_s_ = 0.0f;
};

// What asked for the most, and of several the first.
class Choice {
 public:
  void ask(std::uint32_t count, auto reason) {
    if (count > chosen_.count.count) chosen_ = {{count, true}, reason()};
  }
  PlannedLightSamples take() { return std::move(chosen_); }

 private:
  PlannedLightSamples chosen_{{1, true}, "light comes from far away: nothing of other groups is near"};
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

std::vector<PlannedLightSamples> planLightSamples(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const Motion motion(scene, groups);
  std::vector<Choice> choices(groups.size());
  for (int time = 0; time < motion.times(); ++time) {
    const Moment moment = motion.at(time);
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
        askBy(distance, kMostLightSamples, motion.lampName(lamp));
      }
      for (std::size_t other = 0; other < groups.size(); ++other) {
        const Body& body = moment.bodies[other];
        if (other == g || body.all.empty()) continue;
        if (!body.shining.empty())
          askBy(body.shining.distance(own.centre()), kMostLightSamples,
                "what shines of " + groups[other].name);
        if (body.all.halfSize() < kMuchSmaller * half && body.all.meets(own, kTouch * half))
          choices[g].ask(kMostLightSamples,
                         [&] { return groups[other].name + " can come within its bounds"; });
        askBy(body.all.distance(own.centre()), kOfBodies, groups[other].name);
      }
    }
  }
  std::vector<PlannedLightSamples> out;
  for (Choice& choice : choices) out.push_back(choice.take());
  return out;
}

std::vector<std::string> lightsInside(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const Motion motion(scene, groups);
  std::set<std::pair<std::uint32_t, std::size_t>> known;
  std::vector<std::string> sentences;
  for (int time = 0; time < motion.times(); ++time) {
    const Moment moment = motion.at(time);
    for (const Lamp& lamp : moment.lamps)
      for (std::size_t g = 0; g < groups.size(); ++g) {
        const Box& own = moment.bodies[g].all;
        if (lamp.root == groups[g].root || own.empty() || own.distance(lamp.place) > 0.0f) continue;
        if (!known.emplace(lamp.node, g).second) continue;
        std::string sentence = fmt::format(
            "{} can stand among the surfaces of {}: direct light per pixel by a shadow cube map, its bounces "
            "left out.",
            motion.lampName(lamp), groups[g].name);
        sentence[0] = 'T';
        sentences.push_back(std::move(sentence));
      }
  }
  return sentences;
}

}  // namespace lambent::baker
