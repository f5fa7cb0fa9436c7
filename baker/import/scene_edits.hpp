// Edits that a user made to a scene after its import, so that it can be baked or traced as shown: where nodes
// stand, what materials reflect, how lamps shine. The scene as in its file comes in, and the edited scene
// goes out. Edits refer to parts by index and name. If the file has changed since, an edit follows its name,
// and one without a matching part is skipped with a warning in the scene.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/import/scene.hpp"

namespace lambent::baker {

struct SceneEdits {
  struct Node {
    std::uint32_t index = 0;
    std::string name;
    glm::mat4 parent_from_node{1.0f};
    bool operator==(const Node&) const = default;
  };
  // Holds the values that differ from the file's, by the edit names in the table of a material's fields.
  struct Material {
    using Value = std::variant<float, std::int32_t, glm::vec3>;
    std::uint32_t index = 0;
    std::string name;
    std::map<std::string, Value> values;
    bool operator==(const Material&) const = default;
  };
  // Holds the values of gltf::Light, by the node that carries the light.
  struct Light {
    std::uint32_t node = 0;
    std::string name;  // name of the node
    glm::vec3 color{1.0f};
    float intensity = 1.0f, range_m = 0.0f, inner_cone_rad = 0.0f, outer_cone_rad = 0.785398f;
    bool operator==(const Light&) const = default;
  };
  std::vector<Node> nodes;
  std::vector<Material> materials;
  std::vector<Light> lights;

  bool empty() const { return nodes.empty() && materials.empty() && lights.empty(); }
  bool operator==(const SceneEdits&) const = default;
};

// Returns the edit that turns one material into the other; it has no values if they are the same.
SceneEdits::Material editOf(std::uint32_t index, const gltf::Material& was, const gltf::Material& now);
// Returns both edits of one material as one; `above` wins where both have a value.
SceneEdits::Material overlaid(const SceneEdits::Material& below, SceneEdits::Material above);

void applyEdits(const SceneEdits& edits, Scene& scene);

// Edits as JSON, for world files. readEdits returns nothing if the text holds no edits.
std::string editsText(const SceneEdits& edits);
std::optional<SceneEdits> readEdits(const std::string& text);

// Joins several scenes into one, each at its place in the world, for a picture of everything that is shown.

// Appends all of `from` to `to`, below a new node called `name` at `world_from_scene`. Indices and the source
// of `to` stay unchanged.
void joinScene(Scene from, const std::string& name, const glm::mat4& world_from_scene, Scene& to);

}  // namespace lambent::baker
