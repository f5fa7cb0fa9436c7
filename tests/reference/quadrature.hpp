// Evaluates the GGX lobe independently of the reference, in double precision: the formulas of
// docs/conventions.md, integrated on a regular grid over half vectors distributed by D (the reference samples
// visible normals).
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"

namespace lambent::testing {

struct Ggx {
  double alpha_t = 1.0, alpha_b = 1.0;

  double distribution(const glm::dvec3& h) const {
    const double k = h.x * h.x / (alpha_t * alpha_t) + h.y * h.y / (alpha_b * alpha_b) + h.z * h.z;
    return 1.0 / (std::numbers::pi * alpha_t * alpha_b * k * k);
  }
  // Returns Smith's Lambda.
  double hidden(const glm::dvec3& x) const {
    const double tangent2 = (alpha_t * alpha_t * x.x * x.x + alpha_b * alpha_b * x.y * x.y) / (x.z * x.z);
    return 0.5 * (std::sqrt(1.0 + tangent2) - 1.0);
  }
  // Returns the factors of F0 and F90 in the BRDF, without the cosine.
  glm::dvec2 value(const glm::dvec3& v, const glm::dvec3& s) const {
    const glm::dvec3 h = glm::normalize(v + s);
    const double f = distribution(h) / (1.0 + hidden(v) + hidden(s)) / (4.0 * v.z * s.z);
    const double fresnel = std::pow(1.0 - glm::dot(v, h), 5.0);
    return f * glm::dvec2(1.0 - fresnel, fresnel);
  }

  // Computes ∫ g(s) ds for a g that is large where the lobe is: visit(s, weight) adds g(s) weight. It covers
  // all directions, also those below the surface.
  void integrate(const glm::dvec3& v, const std::function<void(const glm::dvec3&, double)>& visit,
                 int count = 300) const {
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j) {
        // The grid is dense towards both ends, where steep half vectors have much weight.
        const double w = (i + 0.5) / count, share = w * w * (3.0 - 2.0 * w), stretch = 6.0 * w * (1.0 - w);
        const double phi = 2.0 * std::numbers::pi * (j + 0.5) / count;
        const double slope = std::sqrt(share / (1.0 - share));
        const glm::dvec3 h =
            glm::normalize(glm::dvec3(alpha_t * slope * std::cos(phi), alpha_b * slope * std::sin(phi), 1.0));
        const double facing = glm::dot(v, h);
        if (facing <= 0.0) continue;
        // ds = 4 v·h dh, and D(h) n·h dh is the grid's uniform density.
        visit(2.0 * facing * h - v, 4.0 * facing / (distribution(h) * h.z) * stretch / (1.0 * count * count));
      }
  }

  // Returns A and B: the reflection of uniform light towards v, for F0 and F90.
  glm::dvec2 albedo(const glm::dvec3& v) const {
    glm::dvec2 sum(0.0);
    integrate(v, [&](const glm::dvec3& s, double weight) {
      if (s.z > 0.0) sum += value(v, s) * (s.z * weight);
    });
    return sum;
  }
};

// Evaluates the formula for measured BRDFs of docs/conventions.md, "Materials", literally.
inline glm::dvec3 weighedMean(const baker::MeasuredBrdf& brdf, const glm::dvec3& v, const glm::dvec3& s) {
  const auto place = [](const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 h = glm::normalize(a + b);
    return glm::dvec2(std::sqrt(std::acos(std::min(h.z, 1.0)) * 2.0 / std::numbers::pi),
                      std::acos(std::min(glm::dot(a, h), 1.0)) * 2.0 / std::numbers::pi);
  };
  const auto direction = [](double theta, double phi) {
    return glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  const glm::dvec2 here = place(v, s);
  double weights = 0.0;
  glm::dvec3 sum(0.0);
  for (const baker::BrdfMeasurement& m : brdf.measurements) {
    const glm::dvec2 away =
        place(direction(double{m.theta_i}, double{m.phi_i}), direction(double{m.theta_o}, double{m.phi_o})) -
        here;
    const double weight = std::exp(-400.0 * glm::dot(away, away));
    weights += weight;
    sum += weight * glm::dvec3(m.value);
  }
  return sum / weights;
}

}  // namespace lambent::testing
