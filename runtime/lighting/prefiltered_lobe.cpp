#include "runtime/lighting/prefiltered_lobe.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;
constexpr int kSteps = 16384;

double shape(double alpha, double cos_theta) {
  const double half_squared = 0.5 * (1.0 + cos_theta);  // cos² of half the angle
  const double root = half_squared * (alpha * alpha - 1.0) + 1.0;
  return std::max(cos_theta, 0.0) / (root * root);
}

// Returns a quadrature node for theta in 0..pi/2. Nodes are dense near 0, where narrow lobes are.
double thetaAt(double u) {
  return 0.5 * kPi * u * u * u;
}

}  // namespace

float ReflectedLobe::density(float cos_theta) const {
  return scale * static_cast<float>(shape(alpha, cos_theta));
}

float roughnessOfLevel(std::uint32_t level, std::uint32_t levels) {
  return std::pow(static_cast<float>(level) / static_cast<float>(levels - 1), 1.5f);
}

ReflectedLobe makeReflectedLobe(float roughness) {
  ReflectedLobe lobe;
  if (!(roughness > 0.0f)) {
    lobe.bands.fill(1.0f);
    return lobe;
  }
  lobe.alpha = std::max(roughness * roughness, 1e-3f);
  std::vector<double> shares(kSteps);
  double all = 0.0;
  std::array<double, sh::kMaxOrder> bands{};
  for (int i = 0; i < kSteps; ++i) {
    const double low = thetaAt(static_cast<double>(i) / kSteps), high = thetaAt((i + 1.0) / kSteps);
    const double theta = thetaAt((i + 0.5) / kSteps), cosine = std::cos(theta);
    const double ring = 2.0 * kPi * (std::cos(low) - std::cos(high));
    const double share = ring * shape(lobe.alpha, cosine);
    shares[static_cast<std::size_t>(i)] = share;
    all += share;
    for (int l = 0; l < sh::kMaxOrder; ++l)
      bands[static_cast<std::size_t>(l)] += share * sh::legendre(l, cosine);
  }
  lobe.scale = static_cast<float>(1.0 / all);
  for (std::size_t l = 0; l < bands.size(); ++l) lobe.bands[l] = static_cast<float>(bands[l] / all);
  double passed = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    passed += shares[static_cast<std::size_t>(i)] / all;
    while (static_cast<int>(lobe.angles_rad.size()) < kLobeShares &&
           passed >= (static_cast<double>(lobe.angles_rad.size()) + 0.5) / kLobeShares)
      lobe.angles_rad.push_back(static_cast<float>(thetaAt((i + 0.5) / kSteps)));
  }
  lobe.angles_rad.resize(kLobeShares, static_cast<float>(0.5 * kPi));
  return lobe;
}

}  // namespace lambent::lighting
