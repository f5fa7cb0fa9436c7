// Describes a generated scene and writes it as binary glTF 2.0 with one buffer; the same scene gives the same
// bytes. Materials are pure Lambert (metallic 0, roughness 1, KHR_materials_specular with factor 0) unless
// they say otherwise. Every node has translation, rotation and scale, so that editors can move it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "assets/shapes.hpp"
#include "runtime/base/result.hpp"

namespace lambent::assets {

struct Material {
  std::string name;
  glm::vec3 base_color{0.8f};  // linear; multiplies the texture
  glm::vec3 emission{0.0f};    // radiance
  int image = -1;              // index into Scene::images; -1: none
  bool double_sided = false;
  float roughness = 1.0f, metallic = 0.0f;
  float specular = 0.0f;    // KHR_materials_specular
  float anisotropy = 0.0f;  // strength; the direction is the tangent's, which follows the texture coordinates
};

struct Image {
  std::string name;
  std::vector<std::uint8_t> png;
};

struct MaterialMesh {
  std::string name;
  Mesh mesh;
  int material = 0;
};

// A Spot is a light of KHR_lights_punctual that shines along the node's -Z within its cone.
struct Spot {
  std::string name;
  glm::vec3 color{1.0f};
  float intensity_cd = 1.0f;
  float inner_cone_deg = 30.0f, outer_cone_deg = 45.0f;  // half angles
};

// A Motion holds the keys of a node's motion, with as many rotations as times, or none.
struct Motion {
  std::vector<float> times_s;
  std::vector<glm::vec3> translations;
  std::vector<glm::quat> rotations;
};

// A Volume becomes extras.lambent.volume: a medium in a box of `size` about the node's origin.
struct Volume {
  std::string file;
  float density_scale = 1.0f;  // density in m^-1 where the file's value is 1
  glm::vec3 albedo{1.0f};
  glm::vec3 size{1.0f};  // in metres
};

// A Neighborhood becomes extras.lambent.neighborhood: the grid's points around the body, and its extent.
struct Neighborhood {
  glm::ivec3 size{64, 8, 64};
  glm::vec3 extent{1.0f};  // in metres
};

struct Node {
  std::string name;
  int mesh = 0;  // index into Scene::meshes, -1 for none; several nodes may show one mesh
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  float scale = 1.0f;
  int parent = -1;       // index of an earlier node
  int spot = -1;         // index into Scene::spots, -1 for none
  bool movable = false;  // makes a rigid group of its own even without animation
  Motion motion{};       // empty if the node does not move
  std::optional<Volume> volume{};
  std::optional<Neighborhood> neighborhood{};
};

struct Camera {
  std::string name;
  glm::vec3 eye{0.0f, 1.0f, 5.0f}, target{0.0f};
  float yfov_deg = 40.0f;
};

struct Scene {
  std::string name;
  std::vector<Material> materials;
  std::vector<Image> images;
  std::vector<MaterialMesh> meshes;
  std::vector<Spot> spots;
  std::vector<Node> nodes;
  std::vector<Camera> cameras;
};

// Adds a mesh to the scene, and returns its index.
int addMesh(Scene& scene, const std::string& name, Mesh mesh, int material);
// Adds a node that shows a mesh, turned about +Y.
void place(Scene& scene, const std::string& name, int mesh, glm::vec3 at = glm::vec3(0.0f),
           float turn_deg = 0.0f, float scale = 1.0f);
// Adds a mesh, and a node of the same name that shows it.
void show(Scene& scene, const std::string& name, Mesh mesh, int material, glm::vec3 at = glm::vec3(0.0f),
          float turn_deg = 0.0f, float scale = 1.0f);
// Gives a node a motion, with the first key as its place.
void setMotion(Node& node, Motion motion);
// Returns an sRGB PNG of side x side texels.
std::vector<std::uint8_t> squarePng(std::uint32_t side,
                                    const std::function<glm::vec3(std::uint32_t x, std::uint32_t y)>& srgb);

// Errors: the file cannot be written.
Result<void> writeGlb(const std::filesystem::path& path, const Scene& scene);

}  // namespace lambent::assets
