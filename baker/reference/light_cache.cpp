#include "baker/reference/light_cache.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace lambent::baker::reference {

namespace {

bool same(const spec::ProbeLight& a, const spec::ProbeLight& b) {
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

// A sphere or disc that is dragged through the scene leaves the sky as it is.
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

Result<std::shared_ptr<const Environment>> LightCache::environment(const std::vector<spec::Light>& lights,
                                                                   const Options& options) {
  std::vector<FromInfinity> wanted = fromInfinity(lights);
  if (!lights_ || !same(*lights_, wanted)) {
    lights_.reset(), environment_.reset();
    auto loaded = spec::loadDistantLights(lights);
    if (!loaded) return failAgain(std::move(loaded.error()));
    distant_ = std::move(*loaded);
    lights_ = std::move(wanted);
  }
  const int band_limit = options.band_limit ? options.band_limit->in : 0;
  if (!environment_ || turn_deg_ != options.rotate_light_deg || band_limit_ != band_limit) {
    turn_deg_ = options.rotate_light_deg;
    band_limit_ = band_limit;
    environment_ = std::make_shared<const Environment>(distant_, turn_deg_, band_limit_);
  }
  return environment_;
}

}  // namespace lambent::baker::reference
