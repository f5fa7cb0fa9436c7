// The change of the light around bodies as a texture. Comes in: grids of groups, and their points as the
// glossy effect has shaded them, (M - I) l in the body's frame (samples arena, cells of kind Neighborhood).
// Goes out: one 3D texture of half floats with all grids in it (atlas.hpp), looked up by receivers per pixel
// (neighborhood_eval.glsl) and per vertex (neighborhood_vertices.comp). A grid is written anew only when its
// points were shaded anew: under light that does not change against the body, nothing is dispatched. Without
// grids nothing is compiled, held or dispatched. Errors: a kernel that does not compile on this device.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"
#include "runtime/effects/glossy/glossy.hpp"
#include "runtime/effects/neighborhood/atlas.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/gpu/work_list.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/streaming/residency.hpp"

namespace lambent::effects::neighborhood {

struct Grid {
  std::uint32_t group = 0;  // of the residency: whose
  std::uint64_t id = 0;     // of that group
  std::uint64_t key = 0;    // the same for one that takes the place of another
  bundle::NeighborhoodGrid points;
  GridPlace place{};   // outputs 0: no room on this device
  bool ready = false;  // all of it has arrived and is written
};

class Neighborhood {
 public:
  Neighborhood();

  // Which groups have grids; the texture is made anew if they are others than before. One whose place a grid
  // takes that has all arrived, or that stays, is ready still: update() writes it before anybody looks it up.
  void setGrids(std::vector<Grid> grids, const streaming::Residency& residency);
  // Brings the texture up to date with the shaded points.
  Result<void> update(streaming::Residency& residency, const lighting::GroupLights& lights,
                      const glossy::Glossy& glossy, gpu::Counters& counters);

  const std::vector<Grid>& grids() const { return grids_; }
  // Rises when a grid became ready, or lies or counts otherwise than before (Grid::place).
  std::uint64_t version() const { return version_; }
  // Rises when the grid is written.
  std::uint64_t writtenVersion(std::size_t grid) const { return seen_[grid]; }
  std::uint32_t gridsWrittenLast() const { return written_; }
  std::uint64_t bytes() const;  // of the texture
  void bind() const { glBindTextureUnit(kUnitAtlas, atlas_.id()); }
  GLuint texture() const { return atlas_.id(); }
  glm::uvec3 atlasSize() const { return atlas_size_; }

 private:
  Result<void> write(streaming::Residency& residency, gpu::Counters& counters);

  std::vector<Grid> grids_;
  std::vector<std::uint64_t> seen_;  // per grid: version of its shaded points in the texture; 0: none
  std::optional<gpu::Program> program_;
  gpu::Handle<gpu::TextureTraits> atlas_;
  glm::uvec3 atlas_size_{0};
  gpu::Table writes_;
  gpu::WorkList work_;
  std::vector<WriteRecord> records_;
  std::uint64_t version_ = 1;
  std::uint32_t written_ = 0;
};

}  // namespace lambent::effects::neighborhood
