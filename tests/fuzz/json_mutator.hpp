// Changes JSON so that it stays JSON: most mutants get past the parser and into the code behind it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

#include <nlohmann/json.hpp>

// libFuzzer's own mutation of bytes.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

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
    const auto value = static_cast<std::uint64_t>(at.get<std::int64_t>());  // wraps
    at = static_cast<std::int64_t>(random() % 2 != 0 ? value + random() % 5 - 2 : value << random() % 8);
  } else if (at.is_number_float() && random() % 3 != 0) {
    const double factors[] = {-1.0, 0.0, 1e-3, 0.5, 2.0, 1e3, 1e30, 1e-30};
    at = at.get<double>() * factors[random() % std::size(factors)];
  } else {
    at = oddValue(random);
  }
}

// Does what LLVMFuzzerCustomMutator is to do for JSON text: changes it a few times, or its bytes once in
// `blindly` times, and where the text is no JSON or would be too long.
inline std::size_t mutateText(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed,
                              unsigned blindly) {
  Random random(seed);
  nlohmann::json json = nlohmann::json::parse(data, data + size, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded() || random() % blindly == 0) return LLVMFuzzerMutate(data, size, most);
  for (std::uint32_t times = 1 + static_cast<std::uint32_t>(random() % 3); times > 0; --times)
    mutate(json, random);
  const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(text.begin(), text.end(), data);
  return text.size();
}

}  // namespace lambent::fuzz
