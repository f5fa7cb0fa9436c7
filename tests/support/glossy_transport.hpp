// Runs the baker's passes over diffuse and glossy surfaces together, on a scene and with kernels made by the
// test.
#pragma once

#include <cmath>
#include <optional>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::testing {

struct GlossyBake {
  baker::DirectResult direct;  // if there are bounces, with the whole field of glossy samples
  baker::BounceResult bounced;
  std::size_t hits_inside = 0;  // size in bytes of the points inside faces

  std::size_t hitBytes() const { return direct.of(baker::SurfacePart::Glossy).hits.bytes(); }
};

// Selects what is also gathered inside faces and fitted.
enum class Fit { Nothing, DirectLight, AllLight };

struct GlossyBakeSettings {
  int order = 5, order_out = 5;
  int exit_order = 0;  // order of the kernels; 0: order_out
  std::size_t rays = 512;
  int bounces = 0;
  std::size_t hit_memory = std::size_t{1} << 30;
  double tail_error = 1e-3;
  Fit fit = Fit::Nothing;
};

inline GlossyBake bakeGlossy(const Transport& t, const baker::ExitKernels& kernels,
                             const GlossyBakeSettings& settings) {
  const baker::DirectPass pass(
      t.diffuse(), {.order = settings.order,
                    .rays = settings.rays,
                    .keep_hits = settings.bounces != 0,
                    .hit_memory = settings.hit_memory,
                    .colored_kernels = !kernels.grey,
                    .order_out = settings.exit_order > 0 ? settings.exit_order : settings.order_out});
  baker::Progress progress;
  auto direct = baker::bakeDirect(pass, {progress});
  EXPECT_TRUE(direct.has_value());
  GlossyBake bake{std::move(*direct), {}};
  std::optional<baker::InsideFaces> inside;
  if (settings.fit != Fit::Nothing) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < t.geometry.triangles.size(); ++i)
      if (t.samples.vertex_sample[t.geometry.triangles[i].x] >= t.samples.glossy.begin)
        triangles.push_back(i);
    inside.emplace(pass, baker::SurfacePart::Glossy, triangles,
                   bake.direct.of(baker::SurfacePart::Glossy).hits.bytesLeft());
    EXPECT_TRUE(inside->look({progress}) && inside->fitDirect(bake.direct, {}));
    EXPECT_TRUE(baker::diffuseFromGlossy(pass, bake.direct, {}));
    bake.hits_inside = inside->points().direct.of(baker::SurfacePart::Glossy).hits.bytes();
  }
  if (settings.bounces == 0) return bake;
  auto bounced = baker::bakeBounces({.pass = pass,
                                     .direct = bake.direct,
                                     .kernels = &kernels,
                                     .fits = {nullptr, settings.fit == Fit::AllLight ? &*inside : nullptr}},
                                    {settings.bounces, settings.tail_error, settings.order_out}, {progress});
  EXPECT_TRUE(bounced.has_value());
  bake.bounced = std::move(*bounced);
  return bake;
}

// Reads the BRDFs of a scene's surfaces.
struct TransportBrdfs {
  explicit TransportBrdfs(const Transport& t)
      : images(t.scene),
        tables(std::move(*baker::BrdfTables::make(t.scene, 5, 5))),
        brdfs(std::move(*baker::SurfaceBrdfs::load(t.scene, t.geometry, tables, images, 5))) {}
  baker::ExitKernels kernels() const {
    return {brdfs.grey(), [this](std::uint32_t triangle, float u, float v, const glm::vec3& to,
                                 std::span<float> out) { brdfs.exitKernel(triangle, u, v, to, out); }};
  }

  baker::DecodedImages images;
  baker::BrdfTables tables;
  baker::SurfaceBrdfs brdfs;
};

// Describes Lambert surfaces of the scene's own albedo by kernels: albedo A_l/pi y_k(n), where n is the
// face's normal.
inline baker::ExitKernels lambertKernels(const Transport& t) {
  return {t.colors.grey(),
          [&t](std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) {
            const glm::uvec3 c = t.geometry.triangles[triangle];
            const glm::vec3 normal =
                glm::normalize((1.0f - u - v) * t.geometry.normals[c.x] + u * t.geometry.normals[c.y] +
                               v * t.geometry.normals[c.z]);
            const glm::vec3 albedo = t.colors.albedo(triangle, u, v);
            EXPECT_NEAR(glm::length(to), 1.0f, 1e-4f);
            const std::size_t size = out.size() / 3;
            const auto order = static_cast<int>(std::lround(std::sqrt(static_cast<double>(size))));
            sh::unoccludedTransfer(order, normal, out.first(size));
            for (std::size_t k = 0; k < size; ++k) {
              const float value = out[k];
              for (std::size_t channel = 0; channel < 3; ++channel)
                out[channel * size + k] = albedo[static_cast<int>(channel)] * value;
            }
          }};
}

// Returns M of the environment at glossy sample `s` (counted from the first glossy one), channel 0, without
// bounces.
inline std::vector<float> shadowMatrix(const baker::GlossyField& field, std::size_t s) {
  const auto table = sh::makeGauntTable(field.order_in, field.order_out);
  std::vector<float> matrix(
      static_cast<std::size_t>(field.order_in * field.order_in * field.order_out * field.order_out));
  sh::addVisibilityMatrix(table, field.visibilityOf(s), matrix);
  return matrix;
}

// Makes a scene whose samples are all glossy: a metal, so that no draw counts as diffuse.
inline baker::Scene glossyScene(const std::vector<bundle::MeshData>& meshes) {
  baker::Scene scene = sceneOf(meshes);
  scene.materials[0].metallic = 1.0f;
  return scene;
}

}  // namespace lambent::testing
