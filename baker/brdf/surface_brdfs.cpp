#include "baker/brdf/surface_brdfs.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/brdf/brdf.hpp"
#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

namespace {

using bundle::BrdfFamily;
using bundle::BrdfTable;
using bundle::BrdfView;
using bundle::kLeastViewCosine;
using bundle::kMaxBrdfLobes;

constexpr std::size_t kMaxBrdfBands = sh::kMaxFactoredOrder,
                      kMaxBrdfCoefficients = kMaxBrdfBands * kMaxBrdfBands;
using Kernel = std::array<float, kMaxBrdfCoefficients>;

struct Texture {
  std::shared_ptr<const DecodedImage> image;  // null: the texture is 1 everywhere
  gltf::Sampler sampler;
  gltf::TextureRef ref;
};

// A Surface is the material of one draw.
struct Surface {
  gltf::Material material;
  bool glossy = false, colored_vertices = false;
  std::size_t table = 0;  // index in State::tables, if glossy or layered
  bool layered = false;
  glm::vec3 layer{0.0f};  // mean albedo of a smooth dielectric's layer
  LayerAlbedo layer_albedo;
  Texture base, metallic_roughness, specular, specular_color, anisotropy;
};

struct SurfacePoint {
  std::uint32_t triangle;
  float u, v;        // shares of corners 1 and 2
  glm::vec3 normal;  // unit shading normal
};

// Factored is a table with weights of zonal factors in place of coefficients; this is exact between nodes
// too, since look-up and factoring are both linear.
struct Factored {
  BrdfFamily family;
  BrdfTable table;
  sh::ZonalFactors factors;
};

Factored factored(const BrdfTables::Entry& entry) {
  Factored out{entry.family, entry.table,
               sh::ZonalFactors(static_cast<int>(entry.table.order), entry.table.isotropic())};
  const std::size_t count = entry.table.coefficients();
  for (std::size_t first = 0; first < out.table.values.size(); first += count)
    out.factors.factor(std::span(entry.table.values).subspan(first, count),
                       std::span(out.table.values).subspan(first, count));
  return out;
}

bool isGrey(const glm::vec3& color) {
  return color.r == color.g && color.g == color.b;
}

bool isGrey(const Texture& texture) {
  if (!texture.image) return true;
  const auto& rgba = texture.image->rgba;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4)
    if (rgba[i] != rgba[i + 1] || rgba[i] != rgba[i + 2]) return false;
  return true;
}

glm::vec3 unitOr(const glm::vec3& v, const glm::vec3& fallback) {
  const float squared = glm::dot(v, v);
  return squared > 0.0f ? v / std::sqrt(squared) : fallback;
}

glm::vec3 anyAcross(const glm::vec3& n) {
  return unitOr(std::abs(n.x) < 0.6f ? glm::vec3(0.0f, -n.z, n.y) : glm::vec3(-n.y, n.x, 0.0f),
                {1.0f, 0.0f, 0.0f});
}

// A ViewFrame is the frame of a view about a normal; x points along the surface, in the direction that the
// view leans.
struct ViewFrame {
  glm::vec3 x, y, z;
  float cos_theta;
  BrdfView view;  // azimuth folded into the first quadrant
};

// `tangent` is unit and orthogonal to the normal; for isotropic surfaces it may be any such direction.
ViewFrame frameOf(const glm::vec3& normal, const glm::vec3& tangent, const glm::vec3& to) {
  const float cosine = glm::dot(normal, to);
  // A view along the normal has no such direction, and rounding must not choose one.
  const glm::vec3 lean = to - cosine * normal;
  ViewFrame frame{.x = glm::dot(lean, lean) > 1e-8f ? glm::normalize(lean) : tangent,
                  .y = {},
                  .z = normal,
                  .cos_theta = cosine,
                  .view = {}};
  frame.y = glm::cross(normal, frame.x);
  const float cos_phi = glm::dot(frame.x, tangent), sin_phi = glm::dot(frame.x, glm::cross(normal, tangent));
  // A mirrored view uses the mirrored table.
  if (cos_phi * sin_phi < 0.0f) frame.y = -frame.y;
  frame.view = {std::clamp(cosine, kLeastViewCosine, 1.0f), std::abs(cos_phi), std::abs(sin_phi)};
  return frame;
}

// Returns the number of bands of a kernel of three channels.
int bandsOf(std::span<const float> kernel) {
  int order = 1;
  while (3 * static_cast<std::size_t>(sh::coefficientCount(order)) < kernel.size()) ++order;
  assert(3 * static_cast<std::size_t>(sh::coefficientCount(order)) == kernel.size());
  return order;
}

constexpr std::size_t inWholeVectors(std::size_t lanes) {
  return (lanes + 7) / 8 * 8;
}

// Lanes for the axes of a factored function: one per axis, rounded up to whole vectors.
constexpr std::size_t kAxisLanes = inWholeVectors(2 * sh::kMaxFactoredOrder - 1);

// Computes out_k of band l = Σ_i weights[i] harmonics[k][i].
inline void sumAxes(const float* weights, std::size_t axes, std::size_t l, const float* harmonics,
                    float* out) {
  for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) {
    float sum = 0.0f;
    for (std::size_t i = 0; i < axes; ++i) sum += weights[i] * harmonics[k * kAxisLanes + i];
    out[k] = sum;
  }
}

// Band l has l + 1 axes. Since the order is known at compile time, all loops are unrolled.
template <int Order>
void sumIsotropic(const float* weights, const float* harmonics, float* out) {
  sh::detail::unrolled(std::make_integer_sequence<int, Order>{}, [&](auto band) {
    constexpr std::size_t l = band;
    sumAxes(weights + l * (l + 1) / 2, l + 1, l, harmonics, out);
  });
}

// Parameters describe a point of a GGX surface, after textures.
struct Parameters {
  float roughness = 1.0f, metal = 0.0f, transmission = 0.0f;
  glm::vec3 base{0.0f}, f0{0.0f};
  float f90 = 0.0f;
};

// Returns the albedo left to the diffuse part. Band 0 has one axis, and y_00 sqrt(4 pi) = 1, so its weight is
// the lobe's directional albedo. The weights of the second lobe begin at `second`.
glm::vec3 diffuseRest(const Parameters& p, std::span<const float> weights, std::size_t second) {
  const glm::vec3 reflected = p.f0 * weights[0] + p.f90 * weights[second];
  const float rest = 1.0f - std::max({reflected.r, reflected.g, reflected.b});
  return p.metal < 1.0f && rest > 0.0f ? (1.0f - p.metal) * (1.0f - p.transmission) * rest * p.base
                                       : glm::vec3(0.0f);
}

}  // namespace

struct SurfaceBrdfs::State {
  const GroupGeometry* geometry = nullptr;
  bool grey = true;
  std::unique_ptr<Brdf> ggx = makeGgx(/*anisotropic=*/true);
  std::vector<Factored> tables;
  std::vector<Surface> surfaces;                     // one per draw
  std::vector<std::uint32_t> surface_of;             // triangle -> draw
  std::array<float, kMaxBrdfCoefficients> cosine{};  // A_l/pi of coefficient i

  template <typename T>
  T interpolated(const std::vector<T>& values, std::uint32_t triangle, float u, float v) const {
    const glm::uvec3 t = geometry->triangles[triangle];
    return (1.0f - u - v) * values[t.x] + u * values[t.y] + v * values[t.z];
  }
  glm::vec2 texcoord(const gltf::TextureRef& ref, std::uint32_t triangle, float u, float v) const {
    return ref.apply(interpolated(geometry->texcoord_sets[std::min(ref.texcoord, 1u)], triangle, u, v));
  }
  glm::vec4 data(const Texture& texture, std::uint32_t triangle, float u, float v) const {
    if (!texture.image) return glm::vec4(1.0f);
    return nearestData(*texture.image, texture.sampler, texcoord(texture.ref, triangle, u, v));
  }

  glm::vec3 geometricNormal(std::uint32_t triangle) const {
    const glm::uvec3 t = geometry->triangles[triangle];
    const glm::vec3 a = geometry->positions[t.x];
    return glm::cross(geometry->positions[t.y] - a, geometry->positions[t.z] - a);
  }

  glm::vec3 baseColor(const Surface& surface, std::uint32_t triangle, float u, float v) const {
    glm::vec3 color(surface.material.base_color);
    if (surface.base.image)
      color *= glm::vec3(nearestTexel(*surface.base.image, surface.base.sampler,
                                      interpolated(geometry->texcoords, triangle, u, v)));
    if (surface.colored_vertices) color *= glm::vec3(interpolated(geometry->colors, triangle, u, v));
    return glm::clamp(color, 0.0f, 1.0f);
  }

  glm::vec3 normalAt(std::uint32_t triangle, float u, float v) const {
    return unitOr(interpolatedNormal(*geometry, geometry->triangles[triangle], {1.0f - u - v, u, v}),
                  unitOr(geometricNormal(triangle), {0.0f, 1.0f, 0.0f}));
  }

  Parameters parametersAt(const Surface& surface, std::uint32_t triangle, float u, float v) const {
    const gltf::Material& material = surface.material;
    const glm::vec4 rough_metal = data(surface.metallic_roughness, triangle, u, v);
    Parameters p{.roughness = std::clamp(material.roughness * rough_metal.g, 0.0f, 1.0f),
                 .metal = std::clamp(material.metallic * rough_metal.b, 0.0f, 1.0f),
                 .transmission = material.transmits() ? material.transmission : 0.0f,
                 .base = baseColor(surface, triangle, u, v)};
    const float specular = material.specular * data(surface.specular, triangle, u, v).a;
    glm::vec3 tint = material.specular_color;
    if (surface.specular_color.image)
      tint *= glm::vec3(nearestTexel(*surface.specular_color.image, surface.specular_color.sampler,
                                     texcoord(surface.specular_color.ref, triangle, u, v)));
    p.f0 = glm::mix(specular * glm::min(material.reflectance() * tint, glm::vec3(1.0f)), p.base, p.metal);
    p.f90 = glm::mix(specular, 1.0f, p.metal);
    return p;
  }

  // Returns the direction of the longer lobe, unit and orthogonal to `normal`, and the strength; for
  // isotropic surfaces any such direction and strength 0.
  std::pair<glm::vec3, float> leanOf(const Surface& surface, std::uint32_t triangle, float u, float v,
                                     const glm::vec3& normal) const {
    const glm::vec3 any = anyAcross(normal);
    if (tables[surface.table].family != BrdfFamily::AnisotropicGgx) return {any, 0.0f};
    const gltf::Material& material = surface.material;
    float strength = material.anisotropy;
    glm::vec2 lean(1.0f, 0.0f);
    if (surface.anisotropy.image) {
      const glm::vec4 texel = data(surface.anisotropy, triangle, u, v);
      lean = 2.0f * glm::vec2(texel) - 1.0f;
      strength *= texel.b;
    }
    const float c = std::cos(material.anisotropy_rotation_rad),
                s = std::sin(material.anisotropy_rotation_rad);
    lean = {c * lean.x - s * lean.y, s * lean.x + c * lean.y};

    const glm::uvec3 corners = geometry->triangles[triangle];
    glm::vec3 along;
    float handedness = geometry->tangents[corners.x].w;
    if (handedness != 0.0f) {
      along = glm::vec3(interpolated(geometry->tangents, triangle, u, v));
      handedness = handedness < 0.0f ? -1.0f : 1.0f;
    } else {
      // The tangent points to where the texture's u rises; v falls along the bitangent.
      const gltf::TextureRef& ref = material.normal_texture;
      const auto& set = geometry->texcoord_sets[std::min(ref.texcoord, 1u)];
      const glm::vec2 a = ref.apply(set[corners.x]), ab = ref.apply(set[corners.y]) - a,
                      ac = ref.apply(set[corners.z]) - a;
      const glm::vec3 p = geometry->positions[corners.x], pb = geometry->positions[corners.y] - p,
                      pc = geometry->positions[corners.z] - p;
      const float sign = ab.x * ac.y - ac.x * ab.y < 0.0f ? -1.0f : 1.0f;
      along = sign * (ac.y * pb - ab.y * pc);
      handedness = glm::dot(glm::cross(normal, along), sign * (ab.x * pc - ac.x * pb)) < 0.0f ? 1.0f : -1.0f;
    }
    const glm::vec3 tangent = unitOr(along - glm::dot(along, normal) * normal, any);
    return {unitOr(lean.x * tangent + lean.y * handedness * glm::cross(normal, tangent), any), strength};
  }

  PointReflection reflectionAt(const Surface& surface, std::uint32_t triangle, float u, float v,
                               const glm::vec3& to) const {
    const Factored& from = tables[surface.table];
    const glm::vec3 normal = normalAt(triangle, u, v);
    const Parameters p = parametersAt(surface, triangle, u, v);
    const auto [tangent, strength] = leanOf(surface, triangle, u, v, normal);
    std::array<float, kMaxBrdfLobes * kMaxBrdfCoefficients> weights;
    lookUpStored(from.table, frameOf(normal, tangent, to).view, p.roughness, strength, weights);
    const BrdfFocus focus = ggx->focus({p.roughness, strength});
    return {.normal = normal,
            .tangent = tangent,
            .geometric = unitOr(geometricNormal(triangle), normal),
            .alpha_t = static_cast<float>(focus.alpha_t),
            .alpha_b = static_cast<float>(focus.alpha_b),
            .f0 = p.f0,
            .f90 = p.f90,
            .diffuse = diffuseRest(p, weights, from.table.coefficients())};
  }

  // Does what ZonalFactors::expand does, for all lobes at once, with every axis in a lane of its own.
  void expand(const Factored& from, int order, std::span<const float> weights, const ViewFrame& frame,
              std::span<Kernel> lobes) const {
    const std::size_t count = from.table.coefficients();
    const auto axes = from.factors.axes();
    alignas(32) std::array<float, kAxisLanes> x{}, y{}, z{};
    alignas(32) std::array<float, kAxisLanes * kMaxBrdfCoefficients> harmonics;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const glm::vec3 axis = axes[i].x * frame.x + axes[i].y * frame.y + axes[i].z * frame.z;
      x[i] = axis.x, y[i] = axis.y, z[i] = axis.z;
    }
    const std::size_t lanes = inWholeVectors(axes.size());
    sh::evaluateBatch<float>(order, x.data(), y.data(), z.data(), lanes, harmonics.data(), kAxisLanes);
    for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
      const float* own = weights.data() + lobe * count;
      if (!from.table.isotropic()) {
        std::size_t at = 0;
        for (std::size_t l = 0; l < static_cast<std::size_t>(order); at += 2 * l + 1, ++l)
          sumAxes(own + at, 2 * l + 1, l, harmonics.data(), lobes[lobe].data());
        continue;
      }
      sh::withOrder<sh::kMaxFactoredOrder>(
          order, [&](auto bands) { sumIsotropic<bands>(own, harmonics.data(), lobes[lobe].data()); });
    }
  }

  void diffuseKernel(const glm::vec3& color, int order, const glm::vec3& normal, std::span<float> out) const {
    const auto count = static_cast<std::size_t>(sh::coefficientCount(order));
    Kernel y;
    sh::evaluate(order, normal, y);
    for (int c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < count; ++k)
        out[static_cast<std::size_t>(c) * count + k] += color[c] * cosine[k] * y[k];
  }

  void glossyKernel(const Surface& surface, int order, const SurfacePoint& at, const glm::vec3& to,
                    std::span<float> out) const {
    const Factored& from = tables[surface.table];
    const auto count = static_cast<std::size_t>(sh::coefficientCount(order));
    const std::size_t stored = from.table.coefficients();
    std::array<float, kMaxBrdfLobes * kMaxBrdfCoefficients> weights;
    std::array<Kernel, kMaxBrdfLobes> lobes;

    if (from.family == BrdfFamily::Measured) {
      const ViewFrame frame = frameOf(at.normal, anyAcross(at.normal), to);
      lookUpStored(from.table, frame.view, 0.0f, 0.0f, weights);
      expand(from, order, weights, frame, lobes);
      for (std::size_t c = 0; c < 3; ++c)
        std::copy_n(lobes[c].begin(), count, out.begin() + static_cast<std::ptrdiff_t>(c * count));
      return;
    }

    const Parameters p = parametersAt(surface, at.triangle, at.u, at.v);
    const auto [tangent, strength] = leanOf(surface, at.triangle, at.u, at.v, at.normal);
    const ViewFrame frame = frameOf(at.normal, tangent, to);
    lookUpStored(from.table, frame.view, p.roughness, strength, weights);
    expand(from, order, weights, frame, std::span(lobes).first(2));
    for (int c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < count; ++k)
        out[static_cast<std::size_t>(c) * count + k] = p.f0[c] * lobes[0][k] + p.f90 * lobes[1][k];
    if (const glm::vec3 rest = diffuseRest(p, weights, stored); rest != glm::vec3(0.0f))
      diffuseKernel(rest, order, at.normal, out);
  }
};

Result<SurfaceBrdfs> SurfaceBrdfs::load(const Scene& scene, const GroupGeometry& geometry,
                                        const BrdfTables& tables, DecodedImages& images, int order) {
  auto state = std::make_shared<State>();
  state->geometry = &geometry;
  for (int l = 0; l < order; ++l)
    for (int k = l * l; k < (l + 1) * (l + 1); ++k)
      state->cosine[static_cast<std::size_t>(k)] =
          static_cast<float>(sh::clampedCosine(l) / sh::clampedCosine(0));
  for (const BrdfTables::Entry& entry : tables.entries) {
    assert(static_cast<int>(entry.table.order) == order);
    state->tables.push_back(factored(entry));
  }

  state->surface_of.resize(geometry.triangles.size());
  for (const DrawGeometry& draw : geometry.draws) {
    Surface surface;
    if (draw.material < 0)
      surface.material.metallic = 0.0f;  // diffuse white
    else
      surface.material = scene.materials[static_cast<std::size_t>(draw.material)];
    const gltf::Material& material = surface.material;
    const std::int32_t table =
        draw.material < 0 ? -1 : tables.of_material[static_cast<std::size_t>(draw.material)];
    // Draws that were planned as diffuse have no coordinates for the other textures.
    surface.glossy = table >= 0 && draw.kind == SampleKind::Glossy;
    if (surface.glossy) surface.table = static_cast<std::size_t>(table);
    surface.layered = table >= 0 && draw.layered;
    if (surface.layered) {
      surface.table = static_cast<std::size_t>(table);
      surface.layer = meanSpecularAlbedo(material);
      surface.layer_albedo = LayerAlbedo(state->tables[surface.table].table, material);
    }

    std::vector<std::pair<Texture*, const gltf::TextureRef*>> wanted = {
        {&surface.base, &material.base_color_texture}};
    if (surface.glossy)
      wanted.insert(wanted.end(), {{&surface.metallic_roughness, &material.metallic_roughness_texture},
                                   {&surface.specular, &material.specular_texture},
                                   {&surface.specular_color, &material.specular_color_texture},
                                   {&surface.anisotropy, &material.anisotropy_texture}});
    for (const auto& [texture, ref] : wanted) {
      auto image = images.ofTexture(ref->texture);
      if (!image) return failAgain(image.error());
      if (*image)
        *texture = {std::move(*image), scene.textures[static_cast<std::size_t>(ref->texture)].sampler, *ref};
    }

    const auto first = geometry.colors.begin() + draw.first_vertex, last = first + draw.vertex_count;
    surface.colored_vertices =
        std::any_of(first, last, [](const glm::vec4& c) { return glm::vec3(c) != glm::vec3(1.0f); });
    const bool measured = surface.glossy && state->tables[surface.table].family == BrdfFamily::Measured;
    const bool grey_specular =
        !surface.glossy || (isGrey(material.specular_color) && isGrey(surface.specular_color));
    if (!material.unlit &&
        (measured || !grey_specular || !isGrey(surface.layer) || !isGrey(glm::vec3(material.base_color)) ||
         !isGrey(surface.base) ||
         !std::all_of(first, last, [](const glm::vec4& c) { return isGrey(glm::vec3(c)); })))
      state->grey = false;
    std::fill_n(state->surface_of.begin() + draw.first_triangle, draw.triangle_count,
                static_cast<std::uint32_t>(state->surfaces.size()));
    state->surfaces.push_back(std::move(surface));
  }
  return SurfaceBrdfs(std::move(state));
}

bool SurfaceBrdfs::glossy(std::uint32_t triangle) const {
  return state_->surfaces[state_->surface_of[triangle]].glossy;
}

bool SurfaceBrdfs::grey() const {
  return state_->grey;
}

void SurfaceBrdfs::exitKernel(std::uint32_t triangle, float u, float v, const glm::vec3& to,
                              std::span<float> out) const {
  const int order = bandsOf(out);
  std::fill(out.begin(), out.end(), 0.0f);
  const Surface& surface = state_->surfaces[state_->surface_of[triangle]];
  if (surface.material.unlit || glm::dot(state_->geometricNormal(triangle), to) <= 0.0f) return;
  const glm::vec3 normal = state_->normalAt(triangle, u, v);
  if (surface.glossy)
    state_->glossyKernel(surface, order, {triangle, u, v, normal}, to, out);
  else
    state_->diffuseKernel(albedoUnderLayer(state_->baseColor(surface, triangle, u, v), surface.layer), order,
                          normal, out);
}

float SurfaceBrdfs::roughness(std::uint32_t triangle, float u, float v) const {
  const Surface& surface = state_->surfaces[state_->surface_of[triangle]];
  if (!surface.glossy || state_->tables[surface.table].family == BrdfFamily::Measured) return 1.0f;
  return std::clamp(surface.material.roughness * state_->data(surface.metallic_roughness, triangle, u, v).g,
                    0.0f, 1.0f);
}

bool SurfaceBrdfs::layered(std::uint32_t triangle) const {
  return state_->surfaces[state_->surface_of[triangle]].layered;
}

float SurfaceBrdfs::layerAlbedo(std::uint32_t triangle, float cosine) const {
  return state_->surfaces[state_->surface_of[triangle]].layer_albedo.towards(cosine);
}

PointReflection SurfaceBrdfs::reflection(std::uint32_t triangle, float u, float v,
                                         const glm::vec3& to) const {
  const Surface& surface = state_->surfaces[state_->surface_of[triangle]];
  assert((surface.glossy || surface.layered) && state_->tables[surface.table].family != BrdfFamily::Measured);
  return state_->reflectionAt(surface, triangle, u, v, to);
}

}  // namespace lambent::baker
