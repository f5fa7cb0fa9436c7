#include "baker/import/gather_vertices.hpp"

#include <type_traits>
#include <utility>

namespace lambent::baker {

void gatherVertices(bundle::MeshData& mesh, std::span<const std::uint32_t> sources) {
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> gathered;
    gathered.reserve(sources.size());
    for (const std::uint32_t v : sources) gathered.push_back(values[v]);
    values = std::move(gathered);
  };
  gather(mesh.positions);
  gather(mesh.normals);
  gather(mesh.normal_weights);
  gather(mesh.texcoords0);
  gather(mesh.texcoords1);
  gather(mesh.colors);
  gather(mesh.tangents);
}

}  // namespace lambent::baker
