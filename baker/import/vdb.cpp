// Has OpenVDB files read under a limit of memory.
#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "baker/import/density_file.hpp"
#include "baker/import/memory_limit.hpp"
#include "baker/import/openimageio/module.hpp"
#include "baker/import/reason.hpp"
#include "runtime/base/atomic_file.hpp"

namespace lambent::baker {
namespace {

// OpenVDB believes sizes that a damaged file names. An intact fog volume takes up to some hundred times its
// bytes as trees and again as voxels.
constexpr std::uint64_t kLeastRoom = std::uint64_t{1} << 30, kMostRoom = std::uint64_t{6} << 30;
constexpr std::uint64_t kRoomPerByte = 1000;

}  // namespace

Result<DensityGrid> readVdb(const std::filesystem::path& file, const std::string& grid) {
  if (auto checked = checkRegularFile(file, "a .vdb file"); !checked) return failAgain(checked.error());
  const auto reader = openImageIo();
  if (!reader) return failAgain(reader.error());
  std::error_code ignored;
  const std::uint64_t bytes = std::filesystem::file_size(file, ignored);
  const MemoryLimit limit(std::clamp(bytes * kRoomPerByte, kLeastRoom, kMostRoom));
  try {
    return (*reader)->readVdb(file, grid);
  } catch (const std::exception& exception) {
    return fail(file.string(), fmt::format("cannot be read ({})", reasonOf(exception)),
                "take it from its source again");
  }
}

}  // namespace lambent::baker
