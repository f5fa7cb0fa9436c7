// Converts the meshes that a scene draws, each posed at rest.
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "baker/import/check.hpp"
#include "baker/import/convert.hpp"
#include "baker/import/details.hpp"
#include "baker/import/document.hpp"
#include "baker/import/mesh_edits.hpp"
#include "baker/import/texture_transfer.hpp"
#include "runtime/base/finite.hpp"

namespace lambent::baker {
namespace {

// Posed meshes are copies and nodes are cheap to write, so without a limit a small file could claim any
// amount.
constexpr std::size_t kMaxVertices = 1u << 26;

std::vector<float> weightsOf(const nlohmann::json& node, const nlohmann::json& mesh) {
  const auto weights = node.value("weights", std::vector<float>());
  return weights.empty() ? mesh.value("weights", std::vector<float>()) : weights;
}

// Returns whether tangents change the picture. Otherwise they would only cost bytes in the bundle.
bool turnsWithTangents(const gltf::Material& material) {
  return material.normal_texture.texture >= 0 ||
         (material.anisotropy > 0.0f && !material.unlit && material.brdf < 0 && !material.isDiffuse());
}

// Returns the joint matrices of a skin: world at rest from mesh as stored.
std::vector<glm::dmat4> jointMatrices(const Document& document, std::size_t number,
                                      const std::vector<glm::dmat4>& world) {
  const nlohmann::json& skin = document.at("skins", number);
  const nlohmann::json& joints = skin["joints"];
  std::vector<glm::dmat4> matrices(joints.size(), glm::dmat4(1.0));
  if (skin.contains("inverseBindMatrices")) {
    const Floats floats =
        readFloats(document, skin["inverseBindMatrices"].get<std::size_t>(), "inverseBindMatrices", {"MAT4"});
    if (floats.count() < joints.size())
      refuse("skin {}: {} inverse bind matrices for {} joints", number, floats.count(), joints.size());
    for (std::size_t j = 0; j < joints.size(); ++j)
      matrices[j] = glm::dmat4(glm::make_mat4(&floats.values[16 * j]));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    matrices[j] = world[joints[j].get<std::size_t>()] * matrices[j];
    if (!isFinite(matrices[j])) refuse("skin {}: the matrix of joint {} is not finite", number, j);
  }
  return matrices;
}

class MeshConverter {
 public:
  MeshConverter(const Document& document, NodeMap& map, Scene& scene)
      : document_(document), map_(map), scene_(scene), world_(fileWorldTransforms(document)) {}

  void convert() {
    const std::size_t nodes = scene_.nodes.size();  // skins may add some
    for (std::size_t n = 0; n < nodes; ++n)
      if (scene_.nodes[n].mesh >= 0) convertNode(n);
  }

 private:
  void convertNode(std::size_t n) {
    const auto file_node = static_cast<std::size_t>(map_.file_node[n]);
    const nlohmann::json& source = document_.at("nodes", file_node);
    const auto file_mesh = source.at("mesh").get<std::size_t>();
    MeshPose pose{weightsOf(source, document_.at("meshes", file_mesh)), {}};
    const bool skinned = source.contains("skin");
    if (skinned) {
      pose.joints = jointMatrices(document_, source["skin"].get<std::size_t>(), world_);
      scene_.warnings.push_back(
          fmt::format("node {}: its skin stands as the file's joints do and does not move", file_node));
      n = placeSkinned(n, pose);
    }
    // A skinned mesh depends on its node, so no other node draws it.
    const auto [entry, added] = number_.try_emplace(
        {file_mesh, pose.weights, skinned ? static_cast<std::int64_t>(n) : -1}, std::int32_t{-1});
    if (added) {
      SceneMesh mesh = readMesh(file_mesh, pose);
      if (!mesh.primitives.empty()) {
        entry->second = static_cast<std::int32_t>(scene_.meshes.size());
        scene_.meshes.push_back(std::move(mesh));
      }
    }
    scene_.nodes[n].mesh = entry->second;
  }

  // glTF places a skinned mesh by its joints alone. Here it stays at its node, converted to the node's space,
  // so that whatever moves the figure as a whole moves the mesh. If the node's space is flat or mirrored, it
  // gets a node of its own instead, and if the joints are far from it, a child in their midst. Returns the
  // node that draws it.
  std::size_t placeSkinned(std::size_t n, MeshPose& pose) {
    constexpr double kFarFromNode = 1e4;  // floats are 1/1024 apart there
    const glm::dmat4& world = world_[static_cast<std::size_t>(map_.file_node[n])];
    const double size = std::cbrt(std::abs(glm::determinant(glm::dmat3(world))));
    const bool stays = glm::determinant(glm::dmat3(world)) > 0.0 && size > 1e-6;
    if (stays)
      for (glm::dmat4& joint : pose.joints) joint = glm::inverse(world) * joint;
    glm::dvec3 place = glm::round(glm::dvec3(pose.joints.front()[3]));
    if (!(largest(place) > kFarFromNode)) place = glm::dvec3(0.0);
    if (stays && place == glm::dvec3(0.0)) return n;
    for (glm::dmat4& joint : pose.joints) joint = glm::translate(glm::dmat4(1.0), -place) * joint;
    const auto added = static_cast<std::int32_t>(scene_.nodes.size());
    gltf::Node own;
    own.name = scene_.nodes[n].name;
    own.mesh = std::exchange(scene_.nodes[n].mesh, -1);
    own.parent = stays ? static_cast<std::int32_t>(n) : -1;
    own.movable = !stays && scene_.nodes[n].movable;
    own.parent_from_node = glm::translate(glm::mat4(1.0f), glm::vec3(place));
    (stays ? scene_.nodes[n].children : scene_.roots).push_back(added);
    scene_.nodes.push_back(std::move(own));
    map_.file_node.push_back(-1);
    map_.parent_from_node.push_back(glm::translate(glm::dmat4(1.0), place));
    return static_cast<std::size_t>(added);
  }

  SceneMesh readMesh(std::size_t m, const MeshPose& pose) {
    const nlohmann::json& source = document_.at("meshes", m);
    const nlohmann::json& primitives = memberOf(source, {"primitives"});
    SceneMesh mesh{.name = source.value("name", ""), .primitives = {}};
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const nlohmann::json& primitive = primitives[p];
      const std::string name = fmt::format("mesh {}, primitive {}", m, p);
      const std::int32_t material = primitive.value("material", -1);
      const bool tangents =
          material >= 0 && turnsWithTangents(scene_.materials[static_cast<std::size_t>(material)]);
      bundle::MeshData data = readPrimitive(document_, primitive, pose, tangents, name, scene_.warnings);
      if (data.indices.empty()) continue;
      if (!memberOf(primitive, {"targets"}).empty())
        scene_.warnings.push_back(
            fmt::format("{}: its morph targets stand as the file's weights say and do not move", name));
      cleanMesh(data, name, scene_.warnings);
      if (tangents && data.tangents.empty() && !data.indices.empty())
        makeTangents(data, scene_.materials[static_cast<std::size_t>(material)].normal_texture);
      vertices_ += data.positions.size();
      if (vertices_ > kMaxVertices)
        throw Error{{},
                    fmt::format("{} brings the scene to more than {} vertices", name, kMaxVertices),
                    "import it in parts"};
      if (data.indices.empty()) continue;
      mesh.primitives.push_back({.mesh = std::move(data), .material = material});
      if (const std::uint32_t texels = textureTransferOf(source, primitive); texels > 0)
        giveTexels(texels, name, mesh.primitives.back(), scene_.warnings);
    }
    separateDetails(mesh);
    return mesh;
  }

  using Key = std::tuple<std::size_t, std::vector<float>, std::int64_t>;  // mesh, weights, node of a skin
  const Document& document_;
  NodeMap& map_;
  Scene& scene_;
  std::vector<glm::dmat4> world_;
  std::map<Key, std::int32_t> number_;
  std::size_t vertices_ = 0;
};

}  // namespace

void convertMeshes(const Document& document, NodeMap& map, Scene& scene) {
  MeshConverter(document, map, scene).convert();
}

}  // namespace lambent::baker
