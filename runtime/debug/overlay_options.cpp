#include "runtime/debug/overlay_options.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "runtime/spec/numbers.hpp"

namespace lambent::frame {

namespace {

struct OverlayRow {
  std::string_view name;
  bool OverlayOptions::*flag;
  std::string_view former{};  // its former name, which is still understood; may be empty
};

constexpr std::array<OverlayRow, 6> kRows = {
    {{"light-probes", &OverlayOptions::light_probes, "light-samples"},
     {"neighborhoods", &OverlayOptions::neighborhoods},
     {"volumes", &OverlayOptions::volumes},
     {"groups", &OverlayOptions::groups},
     {"lights", &OverlayOptions::lights},
     {"keys", &OverlayOptions::keys}}};

}  // namespace

std::string knownOverlays() {
  std::string known;
  for (const OverlayRow& row : kRows) {
    if (!known.empty()) known += ", ";
    known += row.name;
    if (row.flag == &OverlayOptions::neighborhoods) known += "[:x|y|z,0..1]";
  }
  return known;
}

bool OverlayOptions::shows(std::uint32_t group) const {
  return selected_groups.empty() || std::ranges::find(selected_groups, group) != selected_groups.end();
}

Result<OverlayOptions> parseOverlays(std::string_view list) {
  OverlayOptions options;
  const auto unknown = [&](std::string_view word, std::string_view problem) {
    return fail("overlay", fmt::format("\"{}\" {}", word, problem), "give a list of " + knownOverlays());
  };
  while (!list.empty()) {
    std::size_t end = std::min(list.find(','), list.size());
    std::string_view word = list.substr(0, end);
    const std::size_t colon = word.find(':');
    const std::string_view name = word.substr(0, colon);
    const auto row = std::ranges::find_if(kRows, [&](const OverlayRow& known) {
      return !name.empty() && (name == known.name || name == known.former);
    });
    if (row == kRows.end()) return unknown(word, "is not known");
    options.*row->flag = true;
    if (colon != std::string_view::npos) {
      // The argument has a comma of its own.
      end = std::min(list.find(',', end + 1), list.size());
      word = list.substr(0, end);
      if (row->flag != &OverlayOptions::neighborhoods) return unknown(word, "has no slice");
      const std::string_view place = word.substr(colon + 1);
      const std::size_t axis =
          place.empty() ? std::string_view::npos : std::string_view("xyz").find(place[0]);
      if (axis == std::string_view::npos || place.size() < 3 || place[1] != ',')
        return unknown(word, "is not an axis and a position");
      const std::optional<float> position = spec::parseNumber(std::string(place.substr(2)));
      if (!position || *position < 0.0f || *position > 1.0f)
        return unknown(word, "is not an axis and a position");
      options.slice.axis = static_cast<int>(axis);
      options.slice.position = *position;
    }
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return options;
}

}  // namespace lambent::frame
