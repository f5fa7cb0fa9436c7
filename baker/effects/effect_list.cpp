#include "baker/effects/effect_list.hpp"

#include "baker/effects/diffuse/diffuse.hpp"

namespace lambent::baker {

std::span<const EffectEntry> effectList() {
  static constexpr EffectEntry kEffects[] = {
      {"diffuse", chooseDiffuse},
  };
  return kEffects;
}

}  // namespace lambent::baker
