// Samples incident light on the fly (Sloan, Kautz and Snyder 2002, section 6): around each point the sky and
// the bodies of other rigid groups are drawn into a small cube map in world axes, which is projected to
// spherical harmonics on the GPU. It takes the environment, bodies as capture proxies with one radiance per
// triangle, and points. Some frames later it returns, for each point, the light that arrives there and the
// visible share of each analytic light. Analytic lights are never drawn into texels.
// docs/design/captures.md describes the method. Render thread only. create() fails if a shader does
// not compile on this device.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "runtime/base/result.hpp"
#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/sh/basis.hpp"

namespace lambent::lighting::capture {

struct PreparedProxy;

// Reads results back from the GPU without stalling: they are copied into mapped memory, and a fence tells
// when they have arrived. Sizes are in bytes. A Readback must not outlive its context.
class Readback {
 public:
  Readback() = default;
  Readback(Readback&& other) noexcept { *this = std::move(other); }
  Readback& operator=(Readback&& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(mapped_, other.mapped_);
    std::swap(capacity_, other.capacity_);
    std::swap(used_, other.used_);
    std::swap(fence_, other.fence_);
    return *this;
  }
  ~Readback() { forgetFence(); }

  // Reserves room for this many bytes and discards earlier copies.
  void start(std::size_t byte_count) {
    forgetFence();
    used_ = 0;
    if (byte_count <= capacity_) return;
    capacity_ = byte_count + byte_count / 2;
    GLuint id = 0;
    glCreateBuffers(1, &id);
    buffer_ = gpu::Handle<gpu::BufferTraits>(id);
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(capacity_), nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
    mapped_ = static_cast<const std::byte*>(
        glMapNamedBufferRange(id, 0, static_cast<GLsizeiptr>(capacity_), kAccess));
  }
  // Copies from the start of the buffer and returns the offset at which read() will find the bytes.
  std::size_t copy(const gpu::Buffer& from, std::size_t byte_count) {
    const std::size_t at = used_;
    if (byte_count > 0)
      glCopyNamedBufferSubData(from.id(), buffer_.id(), 0, static_cast<GLintptr>(at),
                               static_cast<GLsizeiptr>(byte_count));
    used_ += byte_count;
    return at;
  }
  void finish() { fence_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0); }

  // Returns whether everything has arrived. This is true if `wait` is set or if nothing was asked for.
  bool arrived(bool wait) {
    if (fence_ == nullptr) return true;
    const GLenum state = glClientWaitSync(fence_, GL_SYNC_FLUSH_COMMANDS_BIT, wait ? GL_TIMEOUT_IGNORED : 0);
    if (state == GL_TIMEOUT_EXPIRED) return false;
    forgetFence();
    return true;
  }
  template <typename T>
  void read(std::size_t offset, std::span<T> values) const {
    if (!values.empty()) std::memcpy(values.data(), mapped_ + offset, values.size_bytes());
  }

 private:
  void forgetFence() {
    if (fence_ != nullptr) glDeleteSync(fence_);
    fence_ = nullptr;
  }

  gpu::Handle<gpu::BufferTraits> buffer_;
  const std::byte* mapped_ = nullptr;
  std::size_t capacity_ = 0, used_ = 0;
  GLsync fence_ = nullptr;
};

// Presents storage buffers as buffer textures to shaders that fetch whole vectors at distant places.

// Binds a view of the buffer. The view is created on first use and attached again on each call, since tables
// move when they grow.
inline void bindTable(gpu::Handle<gpu::TextureTraits>& texture, GLuint unit, GLenum format,
                      const gpu::Buffer& buffer) {
  if (!texture) {
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &id);
    texture = gpu::Handle<gpu::TextureTraits>(id);
  }
  glTextureBuffer(texture.id(), format, buffer.id());
  glBindTextureUnit(unit, texture.id());
  glBindSampler(unit, 0);
}

}  // namespace lambent::lighting::capture

namespace lambent::lighting {

// Owns the sky as the light capture sees it: one small box-filtered cube map in world axes for all points,
// without suns. It takes an environment and provides, per texel (in the order of sh/image_layout.hpp), the
// radiance, and its sum projected to harmonics. Two dispatches remake them
// when the environment was turned, faded or replaced. Render thread only. create() fails if a shader does not
// compile on this device.
class CaptureSky {
 public:
  CaptureSky() = default;
  static Result<CaptureSky> create(const CaptureOptions& options, const Environment& environment);

  // Remakes the cube if the environment changed, and returns whether it did. `weights` is
  // [texel][coefficient] from sh::cubeWeights, padded to fours.
  bool update(const Environment& environment, const gpu::Buffer& weights, gpu::Counters& counters);
  // Binds the texels and the weights that capture_project.comp reads.
  void bindTables(const gpu::Buffer& weights);
  // Returns one vec4 per coefficient: the sum of texels times weights.
  const gpu::Buffer& light() const { return light_; }

 private:
  void takeLights(const Environment& environment);

  CaptureOptions options_;
  gpu::Program program_, light_program_;
  std::array<gpu::Texture, Environment::kSets> environment_maps_;  // light frame, mip maps
  gpu::Sampler sampler_;
  gpu::Buffer texels_, light_;
  gpu::Handle<gpu::TextureTraits> texels_view_, weights_view_;
  std::uint64_t version_ = 0;  // version of the environment that the cube shows; 0: none yet
  std::uint64_t lights_ = 0;   // version of the lights in environment_maps_
};

class Capture {
 public:
  static Result<Capture> create(const CaptureOptions& options, const Environment& environment);
  const CaptureOptions& options() const { return options_; }

  // Sets all proxies. Triangles are numbered through the proxies in the given order. `keys` is empty or has
  // one unique key per proxy; work done for a key that was given before is reused. Must not be called while
  // pending().
  void setProxies(std::span<const bundle::CaptureProxy* const> proxies, gpu::Counters& counters,
                  std::span<const std::uint64_t> keys = {});
  std::uint32_t triangleCount() const { return triangle_count_; }

  // Returns the sphere that capture::sees() takes together with options(), to tell whether a point would have
  // the body drawn at all.
  capture::BodySphere sphereOf(const CaptureBody& body) const;

  // Draws and projects. Each page of cube maps takes at most two draws (bright sides, then dark ones) and two
  // dispatches, and two more dispatches when the environment changed. `triangle_radiance` holds a vec4 per
  // triangle; values that are not finite count as black. Points that see no body cost the GPU nothing.
  // Changes the bound framebuffer, viewport, depth and culling state. Fails if it is called while pending(),
  // if there are fewer radiances than triangles, or if 2^21 bodies or more would be drawn (counted per face
  // of a point).
  Result<void> run(const Environment& environment, std::span<const CaptureBody> bodies,
                   std::span<const CapturePoint> points, const gpu::Buffer& triangle_radiance,
                   gpu::Counters& counters);
  bool pending() const { return pending_; }
  // Returns the light of the last run, one entry per point. Returns nothing if nothing was run, or if the GPU
  // has not finished and `wait` is false.
  std::optional<std::vector<CapturedLight>> take(bool wait);

  // States how much work the cube maps of the last run took.
  struct Load {
    std::uint32_t pages = 0, points = 0, draws = 0;
  };
  const Load& load() const { return load_; }

 private:
  struct Proxy {
    std::optional<std::uint64_t> key;
    std::shared_ptr<const capture::PreparedProxy> prepared;
    std::uint32_t first_triangle = 0, first_vertex = 0;
  };
  struct PageIndices {
    std::uint32_t first = 0, front_only = 0, end = 0;  // triangles seen from one side only come last
  };
  // Holds what take() needs to know about the run.
  struct Run {
    std::vector<CapturePoint> points;
    std::vector<std::uint32_t> records;    // for each point its record on the GPU, or kNoRecord
    std::vector<std::uint32_t> uncovered;  // for each record, the number of texels that no tile covers
    std::vector<std::uint32_t> first_texels, first_words;  // for each record, with the end as last entry
    std::size_t word_count = 0;
    std::size_t results_at = 0, hidden_at = 0, sky_at = 0;  // byte offsets in the readback
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
  View vertices_view_, draws_view_, values_view_, texels_view_;
  capture::Readback readback_;
  std::vector<Proxy> proxies_;
  std::vector<capture::ProxyBounds> bounds_;
  std::uint32_t triangle_count_ = 0;
  std::vector<PageIndices> page_indices_;
  // These lists of indices are drawn once they are uploaded. They are members so that their memory is reused.
  std::vector<std::uint32_t> indices_of_draws_, front_only_;

  bool pending_ = false;
  Run run_;
  bool sky_is_new_ = false;
  sh::LightVector sky_through_texels_;  // as projected from the sky's cube map
  Load load_;
};

}  // namespace lambent::lighting
