// Finds what an object is made of: its primitives and their materials, and what materials look like. Panels
// ask for pictures of materials by their entities; the renderer makes them (editor/render/thumbnails). Main
// thread.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runtime/bundle/gltf_types.hpp"
#include "runtime/ecs/registry.hpp"
#include "runtime/scene/components.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::scene {
struct MaterialComponent;
}

namespace lambent::editor {

class Session;

struct MaterialPictures {
  struct Texture {
    std::string_view use;       // the field of the material: "base_color_texture"
    std::string name;           // of the image
    std::uint32_t picture = 0;  // OpenGL name; 0: it is not loaded
    std::uint32_t width = 0, height = 0;
  };
  struct Pictures {
    std::uint32_t preview = 0;  // OpenGL name of a sphere of the material; 0: not drawn yet
    std::vector<Texture> textures;
  };
  std::set<ecs::Entity> wanted;  // by panels since the last frame
  std::map<ecs::Entity, Pictures> of;
};

// Returns the entities of the materials of a draw, or of all draws at and below a node, each once. They are
// none for other entities.
std::vector<ecs::Entity> materialsOf(const Session& session, ecs::Entity object);
// Returns the measured BRDFs of the bundle that the material belongs to: values of its field, and names.
std::vector<std::pair<std::int32_t, std::string>> measuredBrdfs(const Session& session,
                                                                const scene::MaterialComponent& material);

// Says in words and numbers what a draw is.
struct PrimitiveFacts {
  std::string mesh, shading;
  std::uint32_t vertices = 0, triangles = 0;
};
PrimitiveFacts factsOf(const Session& session, const scene::DrawItem& draw);

// Draws a sphere of a material: its factors under a lamp and a simple sky, without textures. Returns a square
// picture with row 0 at the top, transparent around the sphere.
spec::Rgba8Image previewOf(const gltf::MaterialFactors& material, std::uint32_t size);

}  // namespace lambent::editor
