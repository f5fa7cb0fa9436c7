// Which groups get neighborhood transfer, and for whom: those that extras.lambent.neighborhood names, volumes
// with surfaces in reach, bodies that move about on another group of more than twice their size, and bodies
// that can be moved there by hand. Of many such bodies none: light probes that see all of them cost less
// than a grid for each. What a body does to the groups that its neighborhood carries is left out of their
// light probes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"
#include "baker/plan/facing_area.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

inline constexpr std::size_t kMostNeighborhoods = 8;  // that no one asked for; volumes do not count

struct PlannedNeighborhood {
  bool baked = false;
  bool asked = false;  // by the scene: else it is the plan's own choice, and made with fewer points
  std::string reason;  // a phrase, true either way; empty where nothing speaks for one
  // It is moved by hand, so that receivers may come from all sides, whatever stands around it at rest.
  bool by_hand = false;
  glm::uvec3 size{0};      // points that were asked for; 0: as the bake sees fit
  glm::vec3 extent{0.0f};  // of the grid that was asked for, m; 0: as the bake sees fit
  // Receivers have transfer of their own, finely enough to apply it to the light that the neighborhood
  // changes: all bands are wanted, else the three that a diffuse receiver takes. For what the scene asks for
  // and for volumes: the bands cost several times as much, in the file and whenever the light changes.
  bool matrices = false;
  std::vector<std::uint32_t> receivers;                // groups whose surfaces come within reach
  glm::vec3 receivers_min{0.0f}, receivers_max{0.0f};  // of those surfaces, there; group frame; not by hand
  FacingArea receivers_face{};  // how they face; of glossy ones, which show what is far off too, anywhere

  bool carries(std::size_t group) const {
    return baked && std::find(receivers.begin(), receivers.end(), group) != receivers.end();
  }
};

// One per group. Looks at everything at rest and along the animations, as planLightProbes does.
std::vector<PlannedNeighborhood> planNeighborhoods(const Scene& scene, const std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
