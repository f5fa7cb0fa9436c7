// The programs' only way to OpenImageIO. As Debian builds it, OpenImageIO needs 240 libraries, which take
// half a second to load; so what needs it is a module of its own (liblambent-openimageio.so in the folder
// lib), and programs load it when the first picture is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "baker/import/density_file.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// Holds 8 bits a channel as stored, channels of a pixel side by side, row 0 at the top.
struct Pixels {
  std::uint32_t width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> values;
};

// Lists what the module can do. Functions may throw what OpenImageIO and its libraries throw, which are
// std::exceptions. Errors name `subject`, or the file.
struct OpenImageIo {
  // Decodes a file in memory; `name` says by its ending of which kind it is.
  Result<Pixels> (*decode)(std::span<const std::byte> file, const std::string& name,
                           const std::string& subject);
  // Returns the picture, of three channels, as a JPEG file. Qualities are 1..100.
  Result<std::vector<std::uint8_t>> (*encodeJpeg)(const Pixels& picture, int quality,
                                                  const std::string& subject);
  Result<std::vector<std::uint8_t>> (*encodePng)(const Pixels& picture, const std::string& subject);
  // Reads a grid of an OpenVDB file; see readVdb().
  Result<DensityGrid> (*readVdb)(const std::filesystem::path& file, const std::string& grid);
};

// Returns the module, which stays loaded. Errors: it is not where the program was built or installed, or one
// of its libraries is missing. It may be called from any thread.
Result<const OpenImageIo*> openImageIo();

}  // namespace lambent::baker
