#include "baker/effects/effect_list.hpp"

#include "baker/effects/diffuse/diffuse.hpp"
#include "baker/effects/glossy/glossy.hpp"
#include "baker/effects/neighborhood/neighborhood.hpp"
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

}  // namespace lambent::baker
