// Decides by bounds, without rays, which light inside a rigid group has to be traced. Where no part of a
// group rises above the face of another, as on a convex body or a plane, nothing hides light and no light
// bounces; where all surfaces are black, nothing bounces either. The scene and its groups come in, a decision
// with its reason for each group goes out.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/rigid_groups.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

struct PlannedTransport {
  // True if parts of the group may hide light from each other, so that rays are traced from its samples.
  bool shadows = true;
  bool bounces = true;  // true if light may bounce between its surfaces; false without shadows
  // Each is a phrase that is true either way.
  std::string shadows_reason, bounces_reason;
  // How far a vertex stands above the plane of a face, relative to the group's diagonal, or to the
  // primitive's if that is small enough for a lattice of its own (import/details.hpp); with shadows, of the
  // first that counts, or -1 if there were too many faces to look at.
  double height = 0.0;
  double most_reflected = 1.0;  // share of light that the brightest surface may reflect, from factors alone
};

// Vertices this far above a face, relative to the same diagonal, do not count. The lattice of coded positions
// is about as fine.
inline constexpr double kLevel = 2e-5;
// Surfaces that reflect less are black: of their light at most this share bounces, which is less than any
// quality of bakes leaves out.
inline constexpr double kBlack = 3e-4;

// Returns one entry per group. Volumes have shadows and bounces, since media hide and scatter light.
std::vector<PlannedTransport> planTransport(const Scene& scene, const std::vector<RigidGroup>& groups);

// The room baker/plan decides what will be baked for a scene, what will not, and why: only the effects that a
// scene calls for are simulated. A scene comes in; its rigid groups, their lights, light probes and
// neighborhoods, and a reason for each choice go out. Each effect decides for itself whether the scene calls
// for it (effects.cpp), and `lambent plan` prints the outcome. Planning is deterministic,
// runs on the calling thread and has no errors.

struct EffectChoice {
  std::string effect;
  bool baked = false;
  std::string reason;  // one sentence, which is true either way
};

// EffectEntry is one entry of the list of effects.
struct EffectEntry {
  std::string_view name;
  EffectChoice (*choose)(const Scene& scene, const std::vector<RigidGroup>& groups);
};

// Returns all effects for "auto" and "all", else those of a list such as "diffuse,glossy". The error names
// the effect that is not known.
Result<std::vector<EffectEntry>> effectsNamed(std::string_view words);

struct EffectPlan {
  std::vector<RigidGroup> groups;
  std::vector<EffectChoice> effects;
  std::vector<PlannedTransport> transport;         // one per group
  std::vector<PlannedNeighborhood> neighborhoods;  // one per group; none is baked without that effect
  std::vector<PlannedLightProbes> light_probes;    // one per group
  // Each sentence names something that the scene has and the bake will not show.
  std::vector<std::string> left_out;

  bool bakes(std::string_view effect) const;
};

// `with_insides` keeps the backs of closed double-sided bodies, which nobody sees.
EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects, bool with_insides = false);

// Finds the insides that nobody sees. Exporters mark whole scenes as double-sided, and half of what would be
// baked then lies inside of cushions and table legs. Where every connected part of a double-sided surface is
// closed and faces outwards, and nothing stands within, its backs are left out: the surface is baked and
// drawn as a single-sided one. Materials that let light through or emit it keep both sides.

// Removes these backs from the draws of the groups. Groups may move against each other, and what encloses
// nothing is decided where they stand at rest; cameras, lamps and volumes count as things within.
void leaveOutInsides(const Scene& scene, std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
