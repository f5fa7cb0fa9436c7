// Under which keys the results of a group are kept, by what each truly depends on. Colours are not in what
// rays ask for, the strengths of lamps nowhere, nor names, nor where a movable group stands.
#pragma once

#include <span>

#include "baker/bake/options.hpp"
#include "baker/cache/key.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

struct GroupKeys {
  Key light_probes;
  Key rays;         // pass 0: transfer without a bounce, and what was met
  Key glossy_rays;  // the same of glossy samples
  Key proxy;
  Key bounces;  // and what surfaces reflect
  Key cells;    // and how it is coded: all that a group hands to the bundle
};

GroupKeys groupKeys(const Scene& scene, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
                    LightProbeCount light_probes, const BakeOptions& options);

// Of the tables of b(v) of a scene's glossy materials.
Key brdfTablesKey(const Scene& scene, int order, int shipped);

}  // namespace lambent::baker
