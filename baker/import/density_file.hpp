// Grids of densities from files: OpenVDB (.vdb, through OpenImageIO) and NRRD (.nrrd). Values come as the
// file has them, at voxel centres; what they mean is said by extras.lambent.volume (volumes.cpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kMostVoxelsAlongAnAxis = 2048;
inline constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 28;

struct DensityGrid {
  std::string name;           // of the grid; empty in NRRD files, which hold one without a name
  glm::uvec3 size{0};         // voxels, at least one
  std::vector<float> values;  // x fastest, then y, then z; as in the file: not finite and negative ones too
  // The file's own placement, of voxel coordinates: voxel (i, j, k) fills [i, i + 1] x ...
  glm::dmat4 file_from_grid{1.0};
};

// grid: which one of a file of several; empty: the only one, or "density". Errors: a file that cannot be
// read, a grid that is not there (the error lists those that are), sizes out of range.
Result<DensityGrid> readVdb(const std::filesystem::path& file, const std::string& grid);
Result<DensityGrid> readNrrd(const std::filesystem::path& file);

// Errors name `subject`.
Result<void> checkGridSize(const glm::u64vec3& size, const std::string& subject);

}  // namespace lambent::baker
