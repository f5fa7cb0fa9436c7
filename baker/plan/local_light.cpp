#include "baker/plan/local_light.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/plan/motion.hpp"

namespace lambent::baker {

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
        askBy(distance, kMostLightProbes, motion.lampName(lamp));
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
            "by patches.",
            motion.lampName(lamp), groups[g].name);
        sentence[0] = 'T';
        sentences.push_back(std::move(sentence));
      }
  }
  return sentences;
}

}  // namespace lambent::baker
