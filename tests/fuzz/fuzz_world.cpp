// Reads world files, which are written and read again.
#include "editor/document/world_file.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/json_mutator.hpp"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  return lambent::fuzz::mutateText(data, size, most, seed, /*blindly=*/4);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lambent;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const auto world = editor::parseWorld(text, "world")) {
    const auto again = editor::worldText(*world);
    fuzz::require(again.has_value(), "a world that was read is written");
    fuzz::require(editor::parseWorld(*again, "again").has_value(), "a world that was written is read");
  }
  return 0;
}
