// Finds which of a sample's origins stand where they could be seen: not inside a body, and not where
// something lies on the face. Transfer from such places would leak, as darkness, over the visible parts of
// the faces. If a vertex stands inside or under something while parts of its faces can be seen, its origins
// move towards these parts: what is interpolated over the face then begins with light that is there.
#pragma once

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/transport/direction_table.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

// Holds a few directions that tell whether an origin lies inside something or much is in the way.
struct InsideTestTables {
  DirectionTable glance, look;
  InsideTestTables();
};

struct SeenOrigins {
  std::vector<SampleOrigin> origins;  // weights sum to 1
  bool valid = false;                 // false if no origin is seen; then `origins` holds all of them
  float blocked = 0.0f;               // share of a few rays that hit anything
  bool double_rays = false;           // much is in the way, so that twice the rays should be traced
};

// `frame` is group_from_local of the sample. `seen` is an argument so that its memory can be reused.
void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen);

}  // namespace lambent::baker
