#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stop_token>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/brdf/brdf.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

using bundle::BrdfTable;
using bundle::kLeastViewCosine;
using bundle::kMaxBrdfLobes;

constexpr int kMaxTableBands = sh::kMaxFactoredOrder;
// Directions per view. They leave a mean error over views and roughness of 0.03 % (isotropic) or 0.08 %
// (anisotropic).
constexpr std::size_t kDirections = 4096, kAnisotropicDirections = 2048;

// A View is a direction of view, never quite along the surface, and its frame.
class View {
 public:
  View(double cos_theta, double cos_phi, double sin_phi)
      : cos_theta_(std::clamp(cos_theta, double{kLeastViewCosine}, 1.0)),
        cos_phi_(cos_phi),
        sin_phi_(sin_phi) {}

  // Returns the unit direction; x is the tangent, z the normal.
  glm::dvec3 local() const {
    const double r = std::sqrt(1 - cos_theta_ * cos_theta_);
    return {r * cos_phi_, r * sin_phi_, cos_theta_};
  }
  glm::dvec3 toFrame(const glm::dvec3& s) const {
    return {cos_phi_ * s.x + sin_phi_ * s.y, cos_phi_ * s.y - sin_phi_ * s.x, s.z};
  }

 private:
  double cos_theta_, cos_phi_, sin_phi_;
};

// Returns `count` points of a Fibonacci lattice, spread evenly over the unit disc.
std::vector<glm::dvec2> discPoints(std::size_t count) {
  std::vector<glm::dvec2> points;
  for (std::size_t k = 0; k < count; ++k) {
    const double radius = std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(count));
    const double turn =
        2 * std::numbers::pi * std::fmod(static_cast<double>(k) * (std::numbers::phi - 1), 1.0);
    points.push_back({radius * std::cos(turn), radius * std::sin(turn)});
  }
  return points;
}

// Chooses directions for one view: reflections at half vectors from the view's visible GGX normals (Heitz
// 2018, "Sampling the GGX Distribution of Visible Normals"), and cosine-weighted ones.
class Focused {
 public:
  Focused(const BrdfFocus& focus, const glm::dvec3& v) : focus_(focus), v_(v) {
    stretched_ = glm::normalize(glm::dvec3(focus.alpha_t * v.x, focus.alpha_b * v.y, v.z));
    const double plane = std::hypot(stretched_.x, stretched_.y);
    across_ = plane > 0 ? glm::dvec3(-stretched_.y, stretched_.x, 0) / plane : glm::dvec3(1, 0, 0);
    along_ = glm::cross(stretched_, across_);
    smith_ = glm::length(glm::dvec3(focus.alpha_t * v.x, focus.alpha_b * v.y, v.z)) + v.z;
  }

  // Maps a point of the unit disc to a direction; one below the horizon carries nothing.
  glm::dvec3 reflected(const glm::dvec2& point) const {
    const double share = 0.5 * (1 + stretched_.z);
    const double y = std::lerp(std::sqrt(std::max(0.0, 1 - point.x * point.x)), point.y, share);
    const double z = std::sqrt(std::max(0.0, 1 - point.x * point.x - y * y));
    const glm::dvec3 n = point.x * across_ + y * along_ + z * stretched_;
    const glm::dvec3 h =
        glm::normalize(glm::dvec3(focus_.alpha_t * n.x, focus_.alpha_b * n.y, std::max(n.z, 0.0)));
    return 2 * glm::dot(v_, h) * h - v_;
  }
  static glm::dvec3 cosine(const glm::dvec2& point) {
    return {point, std::sqrt(std::max(0.0, 1 - glm::dot(point, point)))};
  }

  // Returns the density per steradian of both kinds together: G1(v) D(h) / (4 v_z), and cos/pi.
  double density(const glm::dvec3& s) const {
    double density = focus_.cosine_share * s.z * std::numbers::inv_pi;
    if (focus_.cosine_share < 1) {
      const glm::dvec3 h = glm::normalize(v_ + s);
      const double x = h.x / focus_.alpha_t, y = h.y / focus_.alpha_b, width = x * x + y * y + h.z * h.z;
      const double d = 1 / (std::numbers::pi * focus_.alpha_t * focus_.alpha_b * width * width);
      density += (1 - focus_.cosine_share) * d / (2 * smith_);
    }
    return density;
  }

 private:
  BrdfFocus focus_;
  glm::dvec3 v_, stretched_, across_, along_;
  double smith_;
};

// Points are the points of both kinds, the same for all views.
struct Points {
  std::vector<glm::dvec2> half, cosine;

  Points(const BrdfFocus& focus, std::size_t directions) {
    const auto share =
        static_cast<std::size_t>(std::lround(focus.cosine_share * static_cast<double>(directions)));
    cosine = discPoints(share);
    half = discPoints(directions - share);
  }
};

// Accumulates out[lobe * order² + k] = Σ f[lobe] y_k(s), many directions at a time.
class Sums {
 public:
  Sums(int order, std::size_t lobes) : order_(order), lobes_(lobes) {}

  void add(const glm::dvec3& s, const std::array<double, kMaxBrdfLobes>& f) {
    x_[filled_] = s.x, y_[filled_] = s.y, z_[filled_] = s.z;
    for (std::size_t lobe = 0; lobe < lobes_; ++lobe) f_[lobe][filled_] = f[lobe];
    if (++filled_ == kBatch) flush();
  }
  void finish(std::span<double> out) {
    for (; filled_ != 0 && filled_ < kBatch; ++filled_) {
      x_[filled_] = y_[filled_] = 0, z_[filled_] = 1;
      for (std::size_t lobe = 0; lobe < lobes_; ++lobe) f_[lobe][filled_] = 0;
    }
    if (filled_ != 0) flush();
    const auto count = static_cast<std::size_t>(sh::coefficientCount(order_));
    for (std::size_t lobe = 0; lobe < lobes_; ++lobe)
      for (std::size_t k = 0; k < count; ++k) {
        double sum = 0;
        for (const double lane : lanes_[lobe][k]) sum += lane;
        out[lobe * count + k] = sum;
      }
  }

 private:
  static constexpr std::size_t kBatch = 64, kLanes = 8;
  using Batch = std::array<double, kBatch>;

  void flush() {
    const auto count = static_cast<std::size_t>(sh::coefficientCount(order_));
    sh::evaluateBatch(order_, x_.data(), y_.data(), z_.data(), kBatch, basis_.data());
    for (std::size_t lobe = 0; lobe < lobes_; ++lobe)
      for (std::size_t k = 0; k < count; ++k) {
        std::array<double, kLanes> lanes = lanes_[lobe][k];
        const double* basis = basis_.data() + k * kBatch;
        for (std::size_t first = 0; first < kBatch; first += kLanes)
          for (std::size_t lane = 0; lane < kLanes; ++lane)
            lanes[lane] += f_[lobe][first + lane] * basis[first + lane];
        lanes_[lobe][k] = lanes;
      }
    filled_ = 0;
  }

  int order_;
  std::size_t lobes_, filled_ = 0;
  Batch x_, y_, z_;
  std::array<Batch, kMaxBrdfLobes> f_;
  std::array<double, kBatch * kMaxTableBands * kMaxTableBands> basis_;
  std::array<std::array<std::array<double, kLanes>, kMaxTableBands * kMaxTableBands>, kMaxBrdfLobes> lanes_{};
};

void integrate(const Brdf& brdf, const BrdfParameters& at, const View& view, int order, const Points& points,
               std::span<double> out) {
  const glm::dvec3 v = view.local();
  const std::size_t lobes = brdf.lobes(), total = points.half.size() + points.cosine.size();
  assert(order <= kMaxTableBands && lobes <= kMaxBrdfLobes && v.z > 0);
  assert(out.size() >= lobes * static_cast<std::size_t>(sh::coefficientCount(order)));
  BrdfFocus focus = brdf.focus(at);
  focus.cosine_share = static_cast<double>(points.cosine.size()) / static_cast<double>(total);
  const Focused focused(focus, v);
  Sums sums(order, lobes);
  std::array<double, kMaxBrdfLobes> f{};
  const auto add = [&](const glm::dvec3& s) {
    if (s.z <= 0) return;
    const double weight = s.z / (focused.density(s) * static_cast<double>(total));
    brdf.value(at, v, s, f);
    for (std::size_t lobe = 0; lobe < lobes; ++lobe) f[lobe] *= weight;
    sums.add(view.toFrame(s), f);
  };
  for (const glm::dvec2& point : points.half) add(focused.reflected(point));
  for (const glm::dvec2& point : points.cosine) add(Focused::cosine(point));
  sums.finish(out);
}

// Returns the view of a node.
View nodeView(const BrdfGrid& grid, std::size_t angle, std::size_t azimuth) {
  const double u = static_cast<double>(angle) / (grid.angles - 1), past = 1 - u * u;
  const double cos_theta = 1 - past * past;
  if (azimuth == 0) return View(cos_theta, 1, 0);
  if (azimuth + 1 == grid.azimuths) return View(cos_theta, 0, 1);
  const double phi = std::numbers::pi / 2 * static_cast<double>(azimuth) / (grid.azimuths - 1);
  return View(cos_theta, std::cos(phi), std::sin(phi));
}

double unitNode(std::size_t node, std::uint32_t nodes) {
  return nodes > 1 ? static_cast<double>(node) / (nodes - 1) : 0.0;
}

}  // namespace

void integrateView(const Brdf& brdf, const BrdfParameters& at, const bundle::BrdfView& view, int order,
                   std::size_t directions, std::span<double> out) {
  const View exact(double{view.cos_theta}, double{view.cos_phi}, double{view.sin_phi});
  integrate(brdf, at, exact, order, Points(brdf.focus(at), directions), out);
}

BrdfGrid gridFor(const Brdf& brdf, int order) {
  if (!brdf.isotropic()) {
    // Each pair of roughness and strength fills layers of a texture with four values each. OpenGL 4.5
    // guarantees 2048 layers, which limits the number of pairs.
    if (order >= 6) return {.angles = 24, .azimuths = 19, .roughnesses = 14, .strengths = 8};
    return {.angles = 24, .azimuths = 19, .roughnesses = 15, .strengths = 10};
  }
  if (!brdf.hasRoughness()) return {.angles = 96};
  return {.angles = 48, .roughnesses = 32};
}

BrdfTable integrateTable(const Brdf& brdf, int order, const BrdfGrid& grid) {
  BrdfTable table{.order = static_cast<std::uint32_t>(order),
                  .lobes = brdf.lobes(),
                  .angles = grid.angles,
                  .azimuths = grid.azimuths,
                  .roughnesses = grid.roughnesses,
                  .strengths = grid.strengths,
                  .values = {}};
  assert(brdf.isotropic() == table.isotropic());
  table.values.resize(table.nodes() * table.nodeValues());
  const Points points(brdf.focus({}), table.isotropic() ? kDirections : kAnisotropicDirections);
  const std::size_t per_parameter = std::size_t{grid.azimuths} * grid.angles;
  const auto node = [&](std::size_t index) {
    const std::size_t view = index % per_parameter, parameters = index / per_parameter;
    const BrdfParameters at{
        .roughness = static_cast<float>(unitNode(parameters % grid.roughnesses, grid.roughnesses)),
        .strength = static_cast<float>(unitNode(parameters / grid.roughnesses, grid.strengths))};
    std::array<double, kMaxBrdfLobes * kMaxTableBands * kMaxTableBands> b;
    integrate(brdf, at, nodeView(grid, view % grid.angles, view / grid.angles), order, points, b);
    float* out = table.values.data() + index * table.nodeValues();
    for (std::size_t lobe = 0; lobe < table.lobes; ++lobe)
      for (int l = 0; l < order; ++l)
        for (int m = table.isotropic() ? 0 : -l; m <= l; ++m)
          *out++ = static_cast<float>(b[lobe * static_cast<std::size_t>(order * order) +
                                        static_cast<std::size_t>(sh::coefficientIndex(l, m))]);
  };
  parallelRanges(table.nodes(), 8, std::stop_token{}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t index = begin; index < end; ++index) node(index);
  });
  return table;
}

BrdfTable integrateTable(const Brdf& brdf, int order) {
  return integrateTable(brdf, order, gridFor(brdf, order));
}

LayerAlbedo::LayerAlbedo(const bundle::BrdfTable& table, const gltf::Material& material) {
  const glm::vec3 f0 = reflectedStraightOn(material);
  std::array<float, bundle::kMaxBrdfLobes * sh::kMaxFactoredOrder * sh::kMaxFactoredOrder> weights;
  for (std::size_t i = 0; i < kCosines; ++i) {
    const float cosine = static_cast<float>(i) / static_cast<float>(kCosines - 1);
    lookUpStored(table, {std::max(cosine, bundle::kLeastViewCosine), 1.0f, 0.0f},
                 std::clamp(material.roughness, 0.0f, 1.0f), 0.0f, weights);
    const glm::vec3 reflected = f0 * weights[0] + material.specular * weights[table.coefficients()];
    albedos_[i] = std::clamp(std::max({reflected.r, reflected.g, reflected.b}), 0.0f, 1.0f);
  }
}

float LayerAlbedo::towards(float cosine) const {
  const float at = std::clamp(cosine, 0.0f, 1.0f) * static_cast<float>(kCosines - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kCosines - 2);
  return glm::mix(albedos_[below], albedos_[below + 1], at - static_cast<float>(below));
}

}  // namespace lambent::baker
