// Reads grids of densities from files: OpenVDB (.vdb, through OpenImageIO) and NRRD (.nrrd). Values are as in
// the file, at voxel centres; extras.lambent.volume says what they mean (volumes.cpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kMostVoxelsAlongAnAxis = 2048;
inline constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 28;

struct DensityGrid {
  std::string name;           // name of the grid; empty in NRRD files, which hold one without a name
  glm::uvec3 size{0};         // voxels, at least one per axis
  std::vector<float> values;  // x fastest, then y, then z; as in the file, so possibly negative or not finite
  // This is the file's own placement of voxel coordinates, in which voxel (i, j, k) fills [i, i + 1] x ...
  glm::dmat4 file_from_grid{1.0};
};

// `grid` picks one of several in a file; if empty, the only one or "density" is read. Errors: the file cannot
// be read, the grid is not there (the error lists those that are), or sizes are out of range.
Result<DensityGrid> readVdb(const std::filesystem::path& file, const std::string& grid);
Result<DensityGrid> readNrrd(const std::filesystem::path& file);

// Errors name `subject`.
inline Result<void> checkGridSize(const glm::u64vec3& size, const std::string& subject) {
  const bool sides =
      std::max({size.x, size.y, size.z}) <= kMostVoxelsAlongAnAxis && std::min({size.x, size.y, size.z}) >= 1;
  if (sides && size.x * size.y * size.z <= kMostVoxels) return {};
  return fail(subject, fmt::format("has {} x {} x {} voxels", size.x, size.y, size.z),
              fmt::format("save it with 1 to {} along each axis, {} at most in all", kMostVoxelsAlongAnAxis,
                          kMostVoxels));
}

// Makes a fair-weather cloud from a formula, for scenes that ship without files: flat below, with billows on
// billows above. The same seed gives the same cloud.

// Returns 96 x 64 x 96 voxels of size 1/64, centred at the origin, y up; densities are 0..1, and 0 at all
// faces.
DensityGrid proceduralCloud(std::uint32_t seed);

}  // namespace lambent::baker
