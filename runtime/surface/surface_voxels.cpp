#include "runtime/surface/surface_voxels.hpp"

#include <span>
#include <utility>

#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include "runtime/draws/surface_record.hpp"
#include "runtime/surface/reflection_probes_shared.h"
#include "runtime/surface/shaders.hpp"

namespace lambent::frame {

namespace {

constexpr GLint kFromMesh = 0, kCount = 1, kMesh = 2;  // uniform locations

}  // namespace

Result<SurfaceVoxelizer> SurfaceVoxelizer::create() {
  Result<gpu::Program> program =
      gpu::Program::create("surface voxels", {{GL_COMPUTE_SHADER, "surface_voxels.comp"}}, kSurfaceShaders);
  if (!program) return failAgain(program.error());
  SurfaceVoxelizer made;
  made.program_ = std::move(*program);
  return made;
}

lighting::SurfaceVoxels SurfaceVoxelizer::voxelsOf(World& world, std::size_t group,
                                                   gpu::Counters& counters) const {
  const scene::Box& box = world.groupBounds(group);
  lighting::SurfaceVoxels voxels = lighting::SurfaceVoxels::over(box.min, box.max);
  gpu::Table words("surface voxels");
  words.assign(std::span<const std::uint32_t>(voxels.words));
  words.bindStorage(kBindVoxelWords);
  program_.use();
  glUniform3i(kCount, voxels.count.x, voxels.count.y, voxels.count.z);
  const glm::mat4 voxels_from_world = glm::scale(glm::mat4(1.0f), glm::vec3(1.0f / voxels.edge_m)) *
                                      glm::translate(glm::mat4(1.0f), -voxels.origin) *
                                      glm::inverse(world.worldFromGroup(group));
  const streaming::Residency& residency = world.residency();
  for (std::size_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    if (draw.group != group || !mesh.block) continue;
    world.residency().geometry().page(mesh.block.page).bindStorage(kBindVoxelGeometry);
    const glm::mat4 from_mesh = voxels_from_world * describe(world, i).world_from_mesh;
    // Mirrored nodes reverse the winding, and so do the backs of double-sided surfaces.
    const bool over = (glm::determinant(glm::mat3(from_mesh)) < 0.0f) != draw.back;
    const std::uint32_t triangles = mesh.index_count / 3;
    glUniformMatrix4fv(kFromMesh, 1, GL_FALSE, glm::value_ptr(from_mesh));
    glUniform4ui(kMesh, mesh.positions_word, mesh.indices_word, triangles, over ? 1 : 0);
    glDispatchCompute((triangles + kVoxelGroup - 1) / kVoxelGroup, 1, 1);
    ++counters.dispatches;
  }
  words.buffer().read(0, std::span(voxels.words));
  return voxels;
}

}  // namespace lambent::frame
