// Incident light sampled on the fly (Sloan, Kautz and Snyder 2002, section 6): around each point the sky and
// the bodies of other rigid groups are drawn into a small cube map in world axes, and that is projected to
// spherical harmonics on the GPU. Comes in: the environment, bodies as capture proxies with a radiance per
// triangle, points. Goes out, some frames later: per point the light that arrives there and how much of each
// analytic light is not hidden. Analytic lights never pass through the texels. How:
// docs/decisions/captures.md. Errors: shaders that do not compile on this device.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_prepared.hpp"
#include "runtime/lighting/capture_queries.hpp"
#include "runtime/lighting/capture_readback.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/capture_sky.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting {

class Capture {
 public:
  static Result<Capture> create(const CaptureOptions& options, const Environment& environment);
  const CaptureOptions& options() const { return options_; }

  // All proxies; triangles are numbered through them in their order. Not to be called while pending(). keys:
  // empty, or one for each proxy that no other proxy ever has; what was made of one that was given before is
  // used again.
  void setProxies(std::span<const bundle::CaptureProxy* const> proxies, gpu::Counters& counters,
                  std::span<const std::uint64_t> keys = {});
  std::uint32_t firstTriangle(std::size_t proxy) const { return proxies_[proxy].first_triangle; }
  std::uint32_t triangleCount() const { return triangle_count_; }

  // As capture::sees() takes it, with options(): whether a point would have the body drawn at all.
  capture::BodySphere sphereOf(const CaptureBody& body) const;

  // Draws and projects; per page of cube maps at most two draws (surfaces with and without a dark side)
  // and two dispatches, and two when the environment changed. triangle_radiance: vec4 per triangle;
  // what is not finite counts as black. Points that see no body cost the GPU nothing. Not to be called while
  // pending(). Changes the bound framebuffer, viewport, depth and culling state. Errors: called while
  // pending; fewer radiances than triangles; 2^21 bodies to draw, counted per face of a point.
  Result<void> run(const Environment& environment, std::span<const CaptureBody> bodies,
                   std::span<const CapturePoint> points, const gpu::Buffer& triangle_radiance,
                   gpu::Counters& counters);
  bool pending() const { return pending_; }
  // The light of the last run, one per point; none while the GPU is still at it, unless told to wait, or
  // where nothing was run.
  std::optional<std::vector<CapturedLight>> take(bool wait);

  // Of the last run: what its cube maps took. Pixels are subsamples.
  struct Load {
    std::uint32_t pages = 0, points = 0, tiles = 0, draws = 0;
    std::uint64_t triangles = 0, pixels = 0;
  };
  const Load& load() const { return load_; }
  // Texels of the last run, for pictures of what points see: those that a body may show in. They stay until
  // the next run.
  struct Texels {
    std::vector<std::uint32_t> points;     // of each record, which of the points given
    const gpu::Buffer* records = nullptr;  // capture::PointRecord
    const gpu::Buffer* texels = nullptr;   // capture::TexelRecord: which of the cube
    const gpu::Buffer* values = nullptr;   // vec4: mean radiance of bodies; share that they hide
  };
  Texels texels() const;
  // The sky as it comes through the texels, turned in any way, without the correction to the exact light:
  // measures the texels. Waits for the GPU; not to be called while pending().
  sh::LightVector skyThroughTexels(const Environment& environment, const glm::mat3& world_from_light);

 private:
  struct Proxy {
    std::optional<std::uint64_t> key;
    std::shared_ptr<const capture::PreparedProxy> prepared;
    std::uint32_t first_triangle = 0, first_vertex = 0;
  };
  struct PageIndices {
    std::uint32_t first_bright = 0, first_dark = 0, end = 0;
  };
  // What take() needs of the run.
  struct Run {
    std::vector<CapturePoint> points;
    std::vector<std::uint32_t> records;                    // per point its record on the GPU, or kNoRecord
    std::vector<std::uint32_t> uncovered;                  // per record: texels that no tile covers
    std::vector<std::uint32_t> first_texels, first_words;  // per record, and the end
    std::size_t word_count = 0;
    std::size_t results_at = 0, hidden_at = 0, sky_at = 0;  // in the readback
    bool new_sky = false;
    sh::LightVector sky;
  };

  explicit Capture(const CaptureOptions& options);
  sh::LightVector lightFrom(std::span<const glm::vec4> coefficients) const;
  void upload(const capture::Plan& plan, std::span<const CaptureBody> bodies,
              std::span<const CapturePoint> points, gpu::Counters& counters);
  void drawPage(const capture::Page& page, std::size_t index, gpu::Counters& counters);
  void projectPage(const capture::Page& page, const gpu::Buffer& triangle_radiance, gpu::Counters& counters);

  CaptureOptions options_;
  CaptureSky sky_;
  gpu::Program draw_program_, resolve_program_, project_program_;
  gpu::Texture ids_, depths_;
  gpu::Framebuffer atlas_;
  gpu::VertexArray array_;
  gpu::Table vertices_, draws_, indices_, points_, texels_, values_, lookups_, results_, hidden_;
  gpu::Buffer weights_;
  using View = gpu::Handle<gpu::TextureTraits>;
  View vertices_view_, draws_view_, values_view_, texels_view_, weights_view_;
  capture::Readback readback_;
  std::vector<Proxy> proxies_;
  std::vector<capture::ProxyBounds> bounds_;
  std::uint32_t triangle_count_ = 0;
  std::vector<PageIndices> page_indices_;
  // What is drawn, until it is uploaded; kept for their memory.
  std::vector<std::uint32_t> bright_then_dark_, dark_;

  bool pending_ = false;
  Run run_;
  bool sky_is_new_ = false;
  sh::LightVector sky_through_texels_;  // as projected from the sky's cube
  Load load_;
};

}  // namespace lambent::lighting
