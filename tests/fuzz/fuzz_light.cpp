// Reads environment maps. The first byte says of which kind the file is.
#include <cmath>

#include "runtime/spec/distant_lights.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  if (size == 0) return 0;
  constexpr const char* kNames[] = {"map.hdr", "map.exr", "map.png"};
  spec::EnvironmentMapLight light;
  light.file = fuzz::inputFile(kNames[data[0] % std::size(kNames)], {data + 1, size - 1});
  if (const auto map = spec::loadEnvironmentMap(light))
    for (const auto& texel : map->image.texels)
      fuzz::require(std::isfinite(texel.r) && std::isfinite(texel.g) && std::isfinite(texel.b),
                    "a map has no texel that is not finite");
  return 0;
}
