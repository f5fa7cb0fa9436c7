// Which of a sample's origins stand where anybody could see them: not inside a body, nor where something lies
// on the face. Transfer from there would leak, as darkness, over the parts of the faces that are seen.
#pragma once

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "baker/transport/direction_table.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

// A few rays to see whether an origin lies inside something, or much is in the way.
struct InsideTestTables {
  DirectionTable glance, look;
  InsideTestTables();
};

struct SeenOrigins {
  std::vector<SampleOrigin> origins;  // weights sum to 1
  bool valid = false;                 // else none is seen, and these are all
  bool double_rays = false;           // much is in the way: to be looked at with twice the rays
};

// frame: group_from_local of the sample. `seen` is filled, so that it can be used again.
void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen);

}  // namespace lambent::baker
