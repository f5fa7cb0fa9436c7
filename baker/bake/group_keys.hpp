// Makes the keys under which the results of a group are kept. Each key covers only what its result depends
// on: the keys of rays leave out colours, and no key has the strengths of lamps, names, or where a movable
// group stands.
#pragma once

#include <span>

#include "baker/bake/options.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/importance/eyes.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct GroupKeys {
  Key light_probes;
  Key rays;         // of pass 0: direct transfer and the hits of its rays
  Key glossy_rays;  // the same for glossy samples
  Key proxy;
  Key bounces;  // covers also what surfaces reflect
  Key cells;    // covers also how transfer is coded; the result is all that a group hands to the bundle
};

// PlannedGroup is the part of the plan, for one group, on which its results depend.
struct PlannedGroup {
  LightProbeCount light_probes{};
  bool shadows = true, bounces = true;
  std::span<const Eye> cameras{};
};

GroupKeys groupKeys(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
                    const PlannedGroup& planned, const BakeOptions& options);

// Returns the key of the tables of b(v) of a scene's glossy materials.
Key brdfTablesKey(const Scene& scene, int order, int shipped);

}  // namespace lambent::baker
