// Finds the voxels that the surfaces of a rigid group pass through, from the meshes that are resident. It is
// done once when a room arrives, and waits for the GPU. Render thread only. create() fails if the kernel does
// not compile on this device.
#pragma once

#include "runtime/base/result.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/probe_places.hpp"
#include "runtime/world/world.hpp"

namespace lambent::frame {

class SurfaceVoxelizer {
 public:
  static Result<SurfaceVoxelizer> create();
  // Returns the voxels in the group's frame.
  lighting::SurfaceVoxels voxelsOf(World& world, std::size_t group, gpu::Counters& counters) const;

 private:
  gpu::Program program_;
};

}  // namespace lambent::frame
