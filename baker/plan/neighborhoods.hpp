// A FacingArea says which way surfaces face: it holds the sum of their areas times y_k of their normals in
// five bands. Five bands are enough for the mean square over these surfaces of any irradiance, because
// irradiance has three bands and so its square has five. A surface that may face anywhere adds to band 0
// only.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

using FacingArea = std::array<float, 25>;

void addFacing(FacingArea& sum, const glm::vec3& normal, float area);
void addFacingAnywhere(FacingArea& sum, float area);

// Decides which groups get neighborhood transfer, and for which receivers. Groups that get it are those that
// extras.lambent.neighborhood names, volumes with surfaces in reach, bodies that move about on another group
// of more than twice their size, and bodies that can be moved there by hand. If there are too many such
// bodies, none of them gets it, because light probes that see them all cost less than a grid for each. Light
// probes leave out what a neighborhood carries.

// The plan chooses at most this many neighborhoods by itself, not counting those of volumes.
inline constexpr std::size_t kMostNeighborhoods = 8;

struct PlannedNeighborhood {
  bool baked = false;
  bool asked = false;  // the scene asks for it; if not, the plan chose it and it gets fewer points
  std::string reason;  // a phrase that is true either way; empty if nothing speaks for a neighborhood
  // The body is moved by hand, so receivers may come from all sides, whatever stands around it at rest.
  bool by_hand = false;
  glm::uvec3 size{0};      // points that were asked for; 0 leaves the choice to the bake
  glm::vec3 extent{0.0f};  // size of the grid that was asked for, m; 0 leaves the choice to the bake
  // True if the receivers have transfer of their own that is fine enough to apply to the changed light, which
  // takes all bands; false if three bands are enough, as for a diffuse receiver without such transfer. Only
  // volumes and requests of the scene get all bands, which cost several times as much in the file and
  // whenever the light changes.
  bool matrices = false;
  std::vector<std::uint32_t> receivers;  // groups whose surfaces come within reach
  // These are the bounds of the surfaces within reach, in the group frame; unset if `by_hand` is true.
  glm::vec3 receivers_min{0.0f}, receivers_max{0.0f};
  // This says which way the receivers face. Glossy ones count as facing anywhere, since they show far light
  // too.
  FacingArea receivers_face{};

  bool carries(std::size_t group) const {
    return baked && std::find(receivers.begin(), receivers.end(), group) != receivers.end();
  }
};

// Returns one entry per group. Looks at everything at rest and along the animations, as planLightProbes does.
std::vector<PlannedNeighborhood> planNeighborhoods(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
