// Changes JSON so that it stays JSON: most mutants get past the parser and into the code behind it.
#pragma once

#include <random>
#include <string>

#include <nlohmann/json.hpp>

namespace lambent::fuzz {

using Random = std::minstd_rand;

inline nlohmann::json oddValue(Random& random) {
  static const nlohmann::json kOdd[] = {0,
                                        1,
                                        -1,
                                        2,
                                        255,
                                        256,
                                        65535,
                                        65536,
                                        2147483647,
                                        4294967295u,
                                        1e-40,
                                        -1e38,
                                        3e38,
                                        1e308,
                                        0.5,
                                        1e-9,
                                        nullptr,
                                        true,
                                        "",
                                        "a/../b",
                                        "\xc3\xa4",
                                        nlohmann::json::array(),
                                        nlohmann::json::object()};
  return kOdd[random() % std::size(kOdd)];
}

// Changes one value below `at`, which is chosen on a random way down.
inline void mutate(nlohmann::json& at, Random& random) {
  if ((at.is_array() || at.is_object()) && !at.empty() && random() % 8 != 0) {
    auto entry = at.begin();
    std::advance(entry, static_cast<std::ptrdiff_t>(random() % at.size()));
    switch (random() % 16) {
      case 0:
        at.erase(entry);
        return;
      case 1:
        if (at.is_array()) at.push_back(nlohmann::json(*entry));
        return;
      case 2: {
        auto other = at.begin();
        std::advance(other, static_cast<std::ptrdiff_t>(random() % at.size()));
        std::swap(*entry, *other);
        return;
      }
      default:
        return mutate(*entry, random);
    }
  }
  if (at.is_number_integer() && random() % 3 != 0) {
    const auto value = at.get<std::int64_t>();
    at = random() % 2 != 0 ? value + static_cast<std::int64_t>(random() % 5) - 2
                           : static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << random() % 8);
  } else if (at.is_number_float() && random() % 3 != 0) {
    const double factors[] = {-1.0, 0.0, 1e-3, 0.5, 2.0, 1e3, 1e30, 1e-30};
    at = at.get<double>() * factors[random() % std::size(factors)];
  } else {
    at = oddValue(random);
  }
}

// Mutates JSON text a few times. Text that is no JSON is returned as it is.
inline std::string mutatedJson(const std::string& text, Random& random) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return text;
  for (std::uint32_t times = 1 + static_cast<std::uint32_t>(random() % 3); times > 0; --times)
    mutate(json, random);
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace lambent::fuzz
