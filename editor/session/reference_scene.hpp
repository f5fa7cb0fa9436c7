// What a path-traced picture needs of the world beside its scene's file: lights that a person has put there,
// and the strength of the sky.
#pragma once

#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "editor/document/document.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

struct ReferenceLamps {
  struct Lamp {
    gltf::Light light;
    glm::mat4 world_from_node{1.0f};
  };
  std::vector<Lamp> lamps;

  std::string text() const;  // equal texts: equal lamps
};

// Point, spot and directional lights of the world that belong to no bundle.
ReferenceLamps lampsOf(const ecs::Registry& registry, const Document& document);
void addLamps(const ReferenceLamps& lamps, baker::Scene& scene);

// Spheres and discs of light that a person has put into the world.
std::vector<spec::Light> shapesOf(const ecs::Registry& registry, const Document& document);

// Suns and constants times `intensity`; probes have none, and stay.
std::vector<spec::Light> scaledLights(const std::vector<spec::Light>& lights, float intensity);

}  // namespace lambent::editor
