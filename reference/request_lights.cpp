#include "reference/request_lights.hpp"

#include <utility>

namespace lambent::baker::reference {

Result<std::vector<spec::DistantLights>> loadEach(const std::vector<spec::Light>& lights) {
  std::vector<spec::DistantLights> each;
  for (const spec::Light& light : lights) {
    auto loaded = spec::loadDistantLights({light});
    if (!loaded) return failAgain(std::move(loaded.error()));
    each.push_back(std::move(*loaded));
  }
  return each;
}

spec::DistantLights together(const std::vector<spec::DistantLights>& each,
                             const std::vector<float>& factors) {
  spec::DistantLights all;
  for (std::size_t i = 0; i < each.size(); ++i) {
    const float factor = i < factors.size() ? factors[i] : 1.0f;
    all.constant += factor * each[i].constant;
    for (spec::Disc disc : each[i].discs) {
      disc.radiance *= factor;
      all.discs.push_back(disc);
    }
    for (const spec::EnvironmentMap& environment_map : each[i].environment_maps) {
      all.environment_maps.push_back(environment_map);
      if (factor != 1.0f)
        for (glm::vec3& texel : all.environment_maps.back().image.texels) texel *= factor;
    }
    all.notices.insert(all.notices.end(), each[i].notices.begin(), each[i].notices.end());
  }
  return all;
}

void addLights(spec::DistantLights& lights, const spec::DistantLights* more) {
  if (more == nullptr) return;
  lights.constant += more->constant;
  lights.discs.insert(lights.discs.end(), more->discs.begin(), more->discs.end());
  lights.environment_maps.insert(lights.environment_maps.end(), more->environment_maps.begin(),
                                 more->environment_maps.end());
}

}  // namespace lambent::baker::reference
