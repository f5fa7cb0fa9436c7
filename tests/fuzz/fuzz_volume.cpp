// Reads volumes in NRRD files. Those of OpenVDB are read by a library that is not built with sanitizers.
#include "baker/import/density_file.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  if (const auto grid = baker::readNrrd(fuzz::inputFile("volume.nrrd", {data, size})))
    fuzz::require(grid->values.size() == std::size_t{grid->size.x} * grid->size.y * grid->size.z,
                  "a grid has as many values as voxels");
  return 0;
}
