#include "baker/effects/effect_list.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "baker/effects/neighborhood/neighborhood.hpp"
#include "baker/effects/surface/surface_plan.hpp"
#include "baker/effects/volume/volume.hpp"

namespace lambent::baker {

std::span<const EffectEntry> effectList() {
  static constexpr EffectEntry kEffects[] = {
      {"diffuse", chooseDiffuse},
      {"glossy", chooseGlossy},
      {"volume", chooseVolume},
      {"neighborhood", chooseNeighborhood},
  };
  return kEffects;
}

Result<std::vector<EffectEntry>> effectsNamed(std::string_view words) {
  const auto all = effectList();
  if (words == "auto" || words == "all") return std::vector<EffectEntry>(all.begin(), all.end());
  std::vector<EffectEntry> chosen;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string_view name = words.substr(begin, end - begin);
    const auto found = std::ranges::find_if(all, [&](const EffectEntry& e) { return name == e.name; });
    if (found == all.end()) {
      std::string known;
      for (const EffectEntry& entry : all)
        known += fmt::format("{}{}", known.empty() ? "" : ", ", entry.name);
      return fail("--effects", fmt::format("\"{}\" is not an effect", name),
                  "use auto, all or a list of: " + known);
    }
    chosen.push_back(*found);
    begin = end + 1;
  }
  return chosen;
}

}  // namespace lambent::baker
