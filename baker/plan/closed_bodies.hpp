// Finds the insides that nobody sees. Exporters mark whole scenes as double-sided, and half of what would be
// baked then lies inside of cushions and table legs. Where every connected part of a double-sided surface is
// closed and faces outwards, and nothing stands within, its backs are left out: the surface is baked and
// drawn as a single-sided one. Materials that let light through or emit it keep both sides.
#pragma once

#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

// Removes these backs from the draws of the groups. Groups may move against each other, and what encloses
// nothing is decided where they stand at rest; cameras, lamps and volumes count as things within.
void leaveOutInsides(const Scene& scene, std::vector<RigidGroup>& groups);

}  // namespace lambent::baker
