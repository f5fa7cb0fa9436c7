#include "reference/light_cache.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <type_traits>
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

namespace {

bool same(const spec::EnvironmentMapLight& a, const spec::EnvironmentMapLight& b) {
  return a.file == b.file && a.layout == b.layout;
}
bool same(const spec::ConstantLight& a, const spec::ConstantLight& b) {
  return a.radiance == b.radiance;
}
bool same(const spec::SunLight& a, const spec::SunLight& b) {
  return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg && a.angle_deg == b.angle_deg &&
         a.radiance == b.radiance;
}

bool same(const std::vector<LightCache::FromInfinity>& a, const std::vector<LightCache::FromInfinity>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.index() == y.index() &&
           std::visit(
               [&](const auto& light) { return same(light, std::get<std::decay_t<decltype(light)>>(y)); }, x);
  });
}

bool standsInScene(const spec::Light& light) {
  return std::holds_alternative<spec::SphereLight>(light) || std::holds_alternative<spec::DiscLight>(light);
}

// Returns the distant lights only, so that dragging a sphere or disc through the scene does not change the
// sky.
std::vector<LightCache::FromInfinity> fromInfinity(const std::vector<spec::Light>& lights) {
  std::vector<LightCache::FromInfinity> out;
  for (const spec::Light& light : lights)
    std::visit(
        [&](const auto& one) {
          if constexpr (std::is_constructible_v<LightCache::FromInfinity, decltype(one)>)
            out.emplace_back(one);
        },
        light);
  return out;
}

}  // namespace

Result<std::shared_ptr<const Environment>> LightCache::environment(
    const std::vector<spec::Light>& lights, const std::vector<float>& factors, const Options& options,
    const std::shared_ptr<const spec::DistantLights>& more) {
  std::vector<FromInfinity> wanted = fromInfinity(lights);
  if (!lights_ || !same(*lights_, wanted)) {
    lights_.reset(), environment_.reset();
    std::vector<spec::Light> distant;
    std::copy_if(lights.begin(), lights.end(), std::back_inserter(distant), std::not_fn(standsInScene));
    auto loaded = loadEach(distant);
    if (!loaded) return failAgain(std::move(loaded.error()));
    loaded_ = std::move(*loaded);
    lights_ = std::move(wanted);
  }
  // Sphere and disc lights in the list shift the indices of the factors.
  std::vector<float> of_loaded;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (!standsInScene(lights[i])) of_loaded.push_back(i < factors.size() ? factors[i] : 1.0f);
  const int band_limit = options.band_limit ? options.band_limit->in : 0;
  if (!environment_ || factors_ != of_loaded || turn_deg_ != options.rotate_light_deg ||
      band_limit_ != band_limit || more_ != more) {
    more_ = more;
    factors_ = std::move(of_loaded);
    turn_deg_ = options.rotate_light_deg;
    band_limit_ = band_limit;
    spec::DistantLights distant = together(loaded_, factors_);
    addLights(distant, more_.get());
    notices_ = distant.notices;
    environment_ = std::make_shared<const Environment>(std::move(distant), turn_deg_, band_limit_);
  }
  return environment_;
}

}  // namespace lambent::baker::reference
