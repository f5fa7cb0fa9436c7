// Owns the change of the light around bodies as a texture. It takes grids of groups and their points as the
// frame has shaded them, (M - I) l in the body's frame (samples arena, cells of kind Neighborhood),
// and writes one 3D texture of half floats with all grids, which receivers look up per
// pixel (neighborhood_eval.glsl) and per vertex (neighborhood_vertices.comp). A grid is written only when its
// points were shaded: under light that is constant relative to the body, nothing is dispatched. Without grids
// nothing is compiled, held or dispatched. Render thread only. Fails if a kernel does not compile on this
// device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "runtime/base/change_gate.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/effects/neighborhood/neighborhood_shared.h"
#include "runtime/evaluate/samples.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::neighborhood {

// Lays out the grids of all bodies in one 3D texture. Each output of a grid is a slab with one texel per grid
// point; slabs are stacked along z and continue in a neighbouring column when that is full. There is one
// texture for all, so that draws that receive from different bodies share a multi-draw. No GL.
struct GridShape {
  glm::uvec3 size{1};
  std::uint32_t outputs = 9;
};

struct AtlasLayout {
  glm::uvec3 size{0};             // in texels; 0: nothing was placed
  std::vector<GridPlace> places;  // one per shape; outputs is 0 if there was no room
};

// Places large grids first. `max_side` is the limit of a 3D texture on this device; OpenGL 4.5 guarantees
// 2048.
AtlasLayout layOutAtlas(std::span<const GridShape> shapes, std::uint32_t max_side);

struct Grid {
  std::uint32_t group = 0;  // index of its group in the residency
  std::uint64_t id = 0;     // id of that group
  std::uint64_t key = 0;    // kept by a grid that replaces this one
  bundle::NeighborhoodGrid points;
  GridPlace place{};   // outputs 0: no room on this device
  bool ready = false;  // it has arrived as a whole and is written
};

class Neighborhood {
 public:
  Neighborhood();

  // Sets which groups have grids; if they differ from before, the texture is made again. A grid stays ready
  // if the grid with its key was ready before and all its points have arrived: update() writes it before it
  // is looked up.
  void setGrids(std::vector<Grid> grids, const streaming::Residency& residency);
  // Writes the grids whose points were shaded since the last call.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      const evaluate::Samples& samples, gpu::Counters& counters);

  const std::vector<Grid>& grids() const { return grids_; }
  // Rises when a grid becomes ready, or when a Grid::place changes.
  std::uint64_t version() const { return version_; }
  // Rises when the grid is written.
  std::uint64_t writtenVersion(std::size_t grid) const { return written_versions_[grid]; }
  std::uint32_t gridsWrittenLast() const { return written_; }
  void bind() const { atlas_.bind(kUnitAtlas); }
  GLuint texture() const { return atlas_.id(); }
  glm::uvec3 atlasSize() const { return atlas_size_; }

 private:
  Result<void> write(streaming::Residency& residency, gpu::Counters& counters);

  std::vector<Grid> grids_;
  std::vector<std::uint64_t> written_versions_;  // per grid, that of its points when written; 0: none
  gpu::Programs kernels_;
  gpu::Texture atlas_;
  glm::uvec3 atlas_size_{0};
  gpu::Table writes_;
  gpu::WorkList work_;
  std::vector<WriteRecord> records_;
  std::uint64_t version_ = 1;
  std::uint32_t written_ = 0;
};

struct VertexDraw {
  struct From {
    std::uint32_t grid = 0;  // index in the effect
    mat3x4 grid_from_position{0.0f};
    glm::quat group_from_body{1.0f, 0.0f, 0.0f, 0.0f};
    bool operator==(const From&) const = default;
  };
  std::uint32_t draw = 0;  // index in the residency
  std::vector<From> from;
};

// Returns whether everything that the draw needs is resident, in one page: it must be a plain draw with rows,
// and the plain cells of its group must have their transfer of light from the environment in `order` bands.
bool hasTransfer(const streaming::Residency& residency, std::uint32_t draw, std::uint32_t order);

// Shades receivers that have transfer of their own: t_p . dl'(x_p) at every vertex of such draws, in compute,
// from the texture of the neighborhood effect and the receiver's coded transfer. It takes draws with the
// grids that reach them, and provides a second radiance, E/pi, that the raster adds to the draw's own. A draw
// is shaded again if a grid's light, the relative placement of draw and body, or the draw's transfer changed.
// Without such draws nothing is compiled, held or dispatched. Render thread only. Fails if a kernel does not
// compile on this device.
class VertexReceivers {
 public:
  VertexReceivers();

  // `draws` must fulfil hasTransfer() with as many bands as their grids have.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      evaluate::TransferMode mode, const Neighborhood& effect,
                      std::span<const VertexDraw> draws, gpu::Counters& counters);

  // Returns where a draw's second radiance lies, in words; kNoChange if it has none.
  std::uint32_t changeWord(std::uint32_t draw) const {
    const auto found = words_.find(draw);
    return found == words_.end() ? kNoChange : found->second;
  }
  void bindStorage(std::uint32_t binding) const { change_.bindStorage(binding); }
  std::uint32_t drawsShadedLast() const { return shaded_; }

 private:
  // Compares a draw's version, that of its cells, its grids and what is written of them.
  using DrawChanged =
      ChangeGate<std::uint64_t, std::uint64_t, std::vector<VertexDraw::From>, std::vector<std::uint64_t>>;
  struct Places {
    std::uint32_t first = 0;    // index of the group's first sample in the table of places
    std::uint64_t version = 0;  // version of the group's cells
  };
  void layOut(const streaming::Residency& residency, std::span<const VertexDraw> draws);
  bool changed(const streaming::Residency& residency, const Neighborhood& effect, const VertexDraw& draw);
  Result<void> findPlaces(streaming::Residency& residency, gpu::Counters& counters);
  template <typename Record>
  void dispatch(std::span<const Record> records, std::uint32_t largest, gpu::Counters& counters);

  gpu::Programs kernels_;
  std::map<std::uint32_t, std::uint32_t> words_;  // keyed by draw
  std::map<std::uint32_t, Places> places_;        // keyed by group
  std::map<std::uint32_t, DrawChanged> changed_;  // keyed by draw
  ChangeGate<evaluate::TransferMode> mode_changed_;
  ChangeGate<std::uint64_t> structure_changed_;
  gpu::Table change_, sample_places_, arrivals_, transfers_, planes_, block_;
  std::uint32_t shaded_ = 0;
};

}  // namespace lambent::effects::neighborhood
