// Parses words of command lines.
#include "baker/bake/options.hpp"
#include "runtime/spec/camera.hpp"
#include "runtime/spec/light.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  const std::string word(reinterpret_cast<const char*>(data), size);
  static_cast<void>(spec::parseLight(word));
  static_cast<void>(spec::parseLightLayout(word));
  static_cast<void>(spec::parseCamera(word));
  static_cast<void>(spec::parseSize(word));
  static_cast<void>(spec::parseDegrees(word));
  static_cast<void>(spec::parseKeyEdit(word));
  static_cast<void>(baker::gridSizeFrom(word));
  return 0;
}
