#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "baker/decisions/decisions.hpp"
#include "baker/pipeline/job_estimate.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"

namespace lambent::baker {

namespace {

// Bounces that bring less than this share of all light together are not counted in a reason.
constexpr double kRest = 0.003;
// Stages of a bake that trace what is hidden, and that serve refinement.
bool isShadows(std::string_view stage) {
  return stage == "direct light" || stage == "glossy shadows" || stage == "inside faces" ||
         stage == "hierarchy";
}

double secondsOf(const BakeEstimate::Group& group, bool (*is)(std::string_view)) {
  double seconds = 0.0;
  for (const auto& [stage, spent] : group.processor_stages)
    if (is(stage)) seconds += spent;
  return seconds;
}

double refinementOf(const BakeEstimate& estimate) {
  const auto found = estimate.processor_stages.find(kRefinement);
  return found == estimate.processor_stages.end() ? 0.0 : found->second;
}

// Savings reads from the estimates of a group how much each effect costs.
class Savings {
 public:
  Savings(const Estimates& estimates, std::size_t group) {
    const auto& [planned, all] = estimates;
    if (planned && group < planned->groups.size()) planned_ = &planned->groups[group];
    if (all && group < all->groups.size()) all_ = &all->groups[group];
    if (planned && all) refinement_ = std::max(0.0, refinementOf(*all) - refinementOf(*planned));
  }

  Saved shadows(bool baked) const {
    if (baked)
      return planned_ ? Saved{.seconds = secondsOf(*planned_, isShadows), .memory_bytes = {}, .bytes = {}}
                      : Saved{};
    Saved saved = between(isShadows);
    if (saved.bytes) saved.bytes = 0.0;  // light that bounces would take them
    return saved;
  }

  // Hits are kept for bounces alone, and closest hits take longer than any hits.
  Saved bounces(bool baked, bool shadows) const {
    if (baked)
      return planned_ ? Saved{.seconds = secondsOf(*planned_, isBounce),
                              .memory_bytes = planned_->hit_bytes,
                              .bytes = {}}
                      : Saved{};
    Saved saved = between(isBounce);
    if (shadows && planned_ && all_)
      *saved.seconds += std::max(0.0, secondsOf(*all_, isShadows) - secondsOf(*planned_, isShadows));
    if (all_ && planned_) saved.memory_bytes = std::max(0.0, all_->hit_bytes - planned_->hit_bytes);
    return saved;
  }

  std::optional<double> refinement() const { return refinement_; }

 private:
  Saved between(bool (*is)(std::string_view)) const {
    if (!planned_ || !all_) return {};
    return {.seconds = std::max(0.0, secondsOf(*all_, is) - secondsOf(*planned_, is)),
            .memory_bytes = 0.0,
            .bytes = std::max(0.0, all_->bytes - planned_->bytes)};
  }

  const BakeEstimate::Group *planned_ = nullptr, *all_ = nullptr;
  std::optional<double> refinement_;
};

Decision groupShadows(const PlannedTransport& planned, const GroupLook& look, const Savings& savings) {
  Decision d{.effect = "shadows",
             .choice = planned.shadows ? Choice::Baked : Choice::LeftOut,
             .reason = fmt::format("surfaces hide {:.2g} % of the sky's light from each other: {}",
                                   100.0 * look.all.hidden, planned.shadows_reason)};
  d.figures = {{"hiddenLight", 100.0 * look.all.hidden, "%"}};
  if (planned.height >= 0.0)
    d.figures.push_back({"heightAboveFaces", 100.0 * planned.height, "% of the diagonal"});
  d.saves = savings.shadows(planned.shadows);
  return d;
}

// Returns how many bounces bring all but so much of the light.
std::size_t bouncesFor(const GroupLook& look, double rest) {
  std::size_t bounces = 0;
  while (bounces + 1 < look.passes.size() && look.after(bounces) > rest) ++bounces;
  return bounces;
}

Decision groupInterreflection(const Decided& decided, std::size_t group, const Savings& savings) {
  const BakeOptions& options = decided.options;
  const GroupLook& look = decided.looks[group];
  const PlannedTransport& planned = decided.plan.transport[group];
  Decision d{.effect = "interreflection"};
  const double bounced = look.after(0);
  if (!planned.bounces || options.bounces == 0) {
    d.choice = Choice::LeftOut;
    d.reason = fmt::format("{:.2g} % of the light that arrives has bounced: {}", 100.0 * bounced,
                           planned.bounces ? "--bounces 0" : planned.bounces_reason);
  } else {
    const std::size_t needed = bouncesFor(look, kRest),
                      most = options.bounces < 0 ? BakeOptions::kMostBounces
                                                 : static_cast<std::size_t>(options.bounces);
    const std::size_t kept = std::min(needed, most);
    d.reason =
        fmt::format("{:.3g} % of the light that arrives has bounced: {} of {} carry {:.1f} % of all light",
                    100.0 * bounced, kept, counted(most, "bounce"), 100.0 * (1.0 - look.after(kept)));
    d.figures = {{"bounces", static_cast<double>(kept), "bounces"},
                 {"carried", 100.0 * (1.0 - look.after(kept)), "%"}};
  }
  d.figures.insert(d.figures.begin(), {"bouncedLight", 100.0 * bounced, "%"});
  d.figures.push_back({"mostReflected", 100.0 * planned.most_reflected, "%"});
  d.saves = savings.bounces(d.choice == Choice::Baked, planned.shadows);
  return d;
}

// Bands are what is asked for; the reason says what fewer would do.
Decision order(const BakeOptions& options, const GroupLook& look) {
  const auto left = [&](int bands) {
    return static_cast<std::size_t>(bands) < look.from_band.size()
               ? 100.0 * look.from_band[static_cast<std::size_t>(bands)]
               : 0.0;
  };
  int enough = 1;
  while (enough < options.order && left(enough) > 100.0 * kRest) ++enough;
  Decision d{
      .effect = "order",
      .choice = Choice::Baked,
      .reason = enough < options.order
                    ? fmt::format("order {} suffices: it leaves out {:.2g} % of direct light, and order {} "
                                  "{:.2g} %",
                                  enough, left(enough), options.order, left(options.order))
                    : fmt::format("order {} leaves out {:.2g} % of direct light in eight bands, order 3 "
                                  "{:.2g} %; key lights carry what is sharper",
                                  options.order, left(options.order), left(3))};
  d.figures = {{"order", static_cast<double>(options.order), "bands"},
               {"leftOut", left(options.order), "%"},
               {"leftOutByOrder3", left(3), "%"}};
  return d;
}

Decision lamps(const Scene& scene, const RigidGroup& group) {
  const auto lights = findGroupLights(scene, group);
  std::size_t punctual = 0, spheres = 0;
  for (const PlannedLight& light : lights) {
    punctual += light.kind == PlannedLight::Kind::Node;
    spheres += !light.spheres.empty();
  }
  Decision d{.effect = "lamps",
             .choice = lights.empty() ? Choice::Absent : Choice::Baked,
             .reason = lights.empty()
                           ? "0 materials and nodes of the group give off light"
                           : fmt::format(
                                 "{} in a column of transfer each: {} of nodes, {} of which shine as spheres",
                                 counted(lights.size(), "light"), punctual, spheres)};
  d.figures = {{"lights", static_cast<double>(lights.size()), "columns"}};
  if (lights.empty()) d.saves = kSavesNothing;
  return d;
}

Decision refinement(const Decided& decided, std::size_t group, const Savings& savings) {
  const double bound = double{decided.options.effectiveRefineBound()};
  const bool shadows = decided.plan.transport[group].shadows;
  Decision d{.effect = "refinement", .choice = Choice::Baked};
  if (bound > 0.0 && shadows) {
    d.reason = fmt::format("edges are split until interpolation errs by {:.2g} % where shadows change",
                           100.0 * bound);
  } else {
    d.choice = Choice::LeftOut;
    d.reason = shadows ? "--refine off: 0 edges are split" : "0 shadows change between its vertices";
    d.saves.seconds = savings.refinement();
  }
  d.figures = {{"bound", 100.0 * bound, "%"}};
  return d;
}

Decision lightProbes(const PlannedLightProbes& planned) {
  Decision d{.effect = "lightProbes",
             .choice = Choice::Baked,
             .reason = fmt::format("{}{}: {}", counted(planned.count.count, "light probe"),
                                   planned.count.of_group ? "" : " in each cell", planned.reason)};
  d.figures = {{"lightProbes", static_cast<double>(planned.count.count),
                planned.count.of_group ? "of the group" : "of each cell"}};
  return d;
}

Decision neighborhood(const PlannedNeighborhood& planned) {
  Decision d{.effect = "neighborhood",
             .choice = planned.baked            ? Choice::Baked
                       : planned.reason.empty() ? Choice::Absent
                                                : Choice::LeftOut,
             .reason = planned.baked
                           ? fmt::format("{} within reach: {}", counted(planned.receivers.size(), "receiver"),
                                         planned.reason)
                       : planned.reason.empty() ? "0 larger groups have it within their bounds"
                                                : planned.reason};
  d.figures = {{"receivers", static_cast<double>(planned.receivers.size()), "groups"}};
  if (d.choice == Choice::Absent) d.saves = kSavesNothing;
  return d;
}

// Other groups see this one in their light probes, unless its neighborhood carries that.
Decision proxy(const EffectPlan& plan, std::size_t group) {
  std::size_t others = 0;
  for (std::size_t g = 0; g < plan.groups.size(); ++g)
    others += g != group && plan.groups[g].volume < 0 && !plan.neighborhoods[group].carries(g);
  Decision d{.effect = "proxy",
             .choice = Choice::Baked,
             .reason = fmt::format("{} of this scene see it in their light probes, and so do those of other "
                                   "bundles",
                                   counted(others, "group"))};
  d.figures = {{"groups", static_cast<double>(others), "groups"}};
  return d;
}

}  // namespace

std::vector<Decision> groupDecisions(const Decided& decided, std::size_t g) {
  const EffectPlan& plan = decided.plan;
  const RigidGroup& group = plan.groups[g];
  std::vector<Decision> all;
  Decision volume{.effect = "volume",
                  .choice = group.volume < 0 ? Choice::Absent : Choice::Baked,
                  .reason = group.volume < 0 ? "0 media: it is a group of surfaces" : "1 medium"};
  if (group.volume < 0) {
    const Savings savings(decided.estimates, g);
    all = {groupShadows(plan.transport[g], decided.looks[g], savings),
           groupInterreflection(decided, g, savings),
           order(decided.options, decided.looks[g]),
           lamps(decided.scene, group),
           refinement(decided, g, savings),
           proxy(plan, g)};
    volume.saves = kSavesNothing;
  }
  all.push_back(lightProbes(plan.light_probes[g]));
  all.push_back(neighborhood(plan.neighborhoods[g]));
  all.push_back(std::move(volume));
  all.push_back(
      {.effect = "keyLights",
       .choice = Choice::AtRunTime,
       .reason = "what bands cannot carry of the light that a picture is shown under is shaded per pixel; "
                 "lambent-demo --json says how many there are"});
  return all;
}

}  // namespace lambent::baker
