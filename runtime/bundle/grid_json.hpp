// Writes and reads the JSON of a group's volume and neighborhood grids.
#pragma once

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

Json volumeJson(const VolumeGrid& volume);
Json neighborhoodJson(const NeighborhoodGrid& grid);

// Reads the grids of a group whose cells have been read. Throws JsonFault if grids and cells do not agree.
void readGrids(const Field& field, const Description& d, Group& group);

}  // namespace lambent::bundle
