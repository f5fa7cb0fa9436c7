#include "reference/options.hpp"

#include <string>

#include <fmt/format.h>

#include "runtime/sh/basis.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::baker::reference {

Result<BandLimit> parseBandLimit(std::string_view word) {
  const auto wrong = [&] {
    return fail("--band-limit", fmt::format("\"{}\" is not IN or IN,OUT", word),
                fmt::format("give orders 1 to {}, as 5 or 5,5", sh::kMaxOrder));
  };
  const auto numbers = spec::parseNumbers(word);
  if (!numbers || numbers->size() > 2) return wrong();
  for (const float number : *numbers)
    if (number != static_cast<float>(static_cast<int>(number)) || number < 1.0f ||
        number > static_cast<float>(sh::kMaxOrder))
      return wrong();
  BandLimit limit{.in = static_cast<int>((*numbers)[0]), .out = {}};
  if (numbers->size() == 2) limit.out = static_cast<int>((*numbers)[1]);
  return limit;
}

Result<void> checkOptions(const Options& options) {
  if (options.spp < 1 || options.spp > kMaxSpp)
    return fail("--spp", fmt::format("{} samples a pixel are outside 1..{}", options.spp, kMaxSpp),
                "give 64 for a look, 1024 and more for a reference");
  if (options.size.width < 1 || options.size.height < 1 || options.size.width > spec::kMaxPictureSide ||
      options.size.height > spec::kMaxPictureSide)
    return fail("--size", fmt::format("is outside 1..{}", spec::kMaxPictureSide),
                "give WIDTHxHEIGHT in pixels");
  if (options.band_limit) {
    const auto good = [](int order) { return order >= 1 && order <= sh::kMaxOrder; };
    if (!good(options.band_limit->in) || !good(options.band_limit->out.value_or(1)))
      return fail("--band-limit", fmt::format("is outside 1..{}", sh::kMaxOrder),
                  "give IN or IN,OUT, as 5 or 5,5");
  }
  return {};
}

}  // namespace lambent::baker::reference
