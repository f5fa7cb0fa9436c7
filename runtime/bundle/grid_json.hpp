// The JSON of a group's grids: its volume, its neighborhood.
#pragma once

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

Json volumeJson(const VolumeGrid& volume);
Json neighborhoodJson(const NeighborhoodGrid& grid);

// Of a group whose cells have been read: whether the grids and the cells that hold their transfer agree.
void readGrids(const Field& field, const Description& d, Group& group);

}  // namespace lambent::bundle
