// Measures how much light real scenes have per coefficient of each band, which gives the numbers in
// baker/compress/cpca.hpp.
//   light_bands MAP...
// Prints the bands of each environment map and of some discs relative to band 0, and their mean.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"

namespace {

using namespace lambent;
using Bands = std::array<double, sh::kMaxOrder>;

// Returns sum over m and RGB of l_lm² / (2l + 1) for each band, relative to band 0.
Bands bandPower(const sh::LightVector& light) {
  Bands bands{};
  for (int i = 0; i < sh::coefficientCount(light.order); ++i) {
    const glm::dvec3 c(light.c[static_cast<std::size_t>(i)]);
    bands[static_cast<std::size_t>(sh::bandOf(i))] += glm::dot(c, c) / (2.0 * sh::bandOf(i) + 1.0);
  }
  const double first = bands[0];
  for (double& band : bands) band /= first;
  return bands;
}

void print(const std::string& name, const Bands& bands) {
  std::printf("%-28s", name.c_str());
  for (const double band : bands) std::printf(" %7.4f", band);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Bands> all;
  for (int i = 1; i < argc; ++i) {
    const auto environment_map = spec::loadEnvironmentMap({argv[i], std::nullopt});
    if (!environment_map) {
      std::fprintf(stderr, "light_bands: %s\n", environment_map.error().line().c_str());
      return 1;
    }
    const auto& image = environment_map->image;
    all.push_back(
        bandPower(sh::projectImage(sh::kMaxOrder, environment_map->layout, static_cast<int>(image.width),
                                   static_cast<int>(image.height), image.texels)));
    print(std::filesystem::path(argv[i]).filename().string(), all.back());
  }
  for (const double degrees : {10.0, 20.0, 40.0, 60.0}) {
    all.push_back(bandPower(sh::discLight(sh::kMaxOrder, glm::vec3(0, 0, 1),
                                          degrees * 3.14159265358979 / 180.0, glm::vec3(1.0f))));
    print("disc of " + std::to_string(static_cast<int>(degrees)) + " degrees", all.back());
  }
  Bands mean{};
  for (const Bands& bands : all)
    for (std::size_t l = 0; l < mean.size(); ++l) mean[l] += bands[l] / static_cast<double>(all.size());
  print("mean", mean);
  return 0;
}
