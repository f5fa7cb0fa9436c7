// Builds the scene that the reference traces: the world's scenes as they are edited and placed, and the
// lights that a person has added.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/import/scene_edits.hpp"
#include "editor/document/document.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

// Identifies a scene that is shown, and its edits and placement.
struct ReferencePart {
  std::filesystem::path source;
  std::filesystem::file_time_type time;
  std::string name;
  baker::SceneEdits edits;
  glm::mat4 world_from_scene{1.0f};
  glm::dvec3 origin{0.0};  // of the world, frame::World::origin()
  bool operator==(const ReferencePart&) const = default;
};

struct ReferenceLamps {
  struct Lamp {
    gltf::Light light;
    glm::mat4 world_from_node{1.0f};
  };
  std::vector<Lamp> lamps;

  std::string text() const;  // equal texts mean equal lamps
};

// Returns the point, spot and directional lights of the world that belong to no bundle.
ReferenceLamps lampsOf(const ecs::Registry& registry, const Document& document);
void addLamps(const ReferenceLamps& lamps, baker::Scene& scene);

// Joins all parts into one scene, with animations at this time in seconds. It is slow and may run on any
// thread. Errors: those of importing a part.
Result<baker::Scene> makeReferenceScene(const std::vector<ReferencePart>& parts, const ReferenceLamps& lamps,
                                        float animation_s);

// Returns the spherical and disc lights that a person has added to the world.
std::vector<spec::Light> shapesOf(const ecs::Registry& registry, const Document& document);

}  // namespace lambent::editor
