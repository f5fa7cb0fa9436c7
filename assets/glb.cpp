#include "assets/glb.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <nlohmann/json.hpp>

#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::assets {

namespace {

using Json = nlohmann::ordered_json;  // keeps members in the order in which they are written

// These are glTF's GL constants.
constexpr int kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;

Json toJson(glm::vec3 v) {
  return {v.x, v.y, v.z};
}
Json toJson(glm::quat q) {
  return {q.x, q.y, q.z, q.w};
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  std::string write() {
    Json meshes = Json::array(), materials = Json::array();
    for (const MaterialMesh& mesh : scene_.meshes) meshes.push_back(meshJson(mesh));
    for (const Material& material : scene_.materials) materials.push_back(materialJson(material));
    Json json = {{"asset", {{"version", "2.0"}, {"generator", "lambent-assets"}}},
                 {"extensionsUsed", extensionsUsed()},
                 {"scene", 0}};
    addNodes(json);
    addAnimation(json);
    if (!scene_.spots.empty()) json["extensions"] = {{"KHR_lights_punctual", {{"lights", spotsJson()}}}};
    json["meshes"] = std::move(meshes);
    json["materials"] = std::move(materials);
    if (!scene_.images.empty()) addTextures(json);
    json["accessors"] = std::move(accessors_);
    json["bufferViews"] = std::move(views_);
    align(binary_, '\0');
    json["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    return glb(json.dump());
  }

 private:
  static void align(std::string& bytes, char padding) {
    while (bytes.size() % 4) bytes += padding;
  }

  int addView(const void* data, std::size_t length, int target) {
    align(binary_, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", length}};
    if (target) view["target"] = target;
    binary_.append(static_cast<const char*>(data), length);
    views_.push_back(std::move(view));
    return static_cast<int>(views_.size()) - 1;
  }

  template <typename T>
  int addAccessor(std::span<const T> values, const char* type, int component, int target,
                  const Json& extra = {}) {
    Json accessor = {{"bufferView", addView(values.data(), values.size_bytes(), target)},
                     {"componentType", component},
                     {"count", values.size()},
                     {"type", type}};
    if (extra.is_object()) accessor.update(extra);
    accessors_.push_back(std::move(accessor));
    return static_cast<int>(accessors_.size()) - 1;
  }

  Json meshJson(const MaterialMesh& item) {
    const Mesh& mesh = item.mesh;
    glm::vec3 low = mesh.positions.front(), high = low;
    for (const glm::vec3 position : mesh.positions)
      low = glm::min(low, position), high = glm::max(high, position);
    Json attributes;
    attributes["POSITION"] = addAccessor(std::span(mesh.positions), "VEC3", kFloat, kArrayBuffer,
                                         {{"min", toJson(low)}, {"max", toJson(high)}});
    attributes["NORMAL"] = addAccessor(std::span(mesh.normals), "VEC3", kFloat, kArrayBuffer);
    if (!mesh.texcoords.empty())
      attributes["TEXCOORD_0"] = addAccessor(std::span(mesh.texcoords), "VEC2", kFloat, kArrayBuffer);
    const int indices = addAccessor(std::span(mesh.indices), "SCALAR", kUnsignedInt, kElementArrayBuffer);
    return {{"name", item.name},
            {"primitives",
             Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", item.material}}})}};
  }

  Json extensionsUsed() const {
    Json used = Json::array({"KHR_materials_specular"});
    const auto glows = [](const Material& material) { return material.emission != glm::vec3(0.0f); };
    if (std::ranges::any_of(scene_.materials, glows)) used.push_back("KHR_materials_emissive_strength");
    const auto brushed = [](const Material& material) { return material.anisotropy > 0.0f; };
    if (std::ranges::any_of(scene_.materials, brushed)) used.push_back("KHR_materials_anisotropy");
    if (!scene_.spots.empty()) used.push_back("KHR_lights_punctual");
    return used;
  }

  Json spotsJson() const {
    Json lights = Json::array();
    const auto radians = [](float degrees) { return degrees * std::numbers::pi_v<float> / 180.0f; };
    for (const Spot& spot : scene_.spots)
      lights.push_back({{"name", spot.name},
                        {"type", "spot"},
                        {"color", toJson(spot.color)},
                        {"intensity", spot.intensity_cd},
                        {"spot",
                         {{"innerConeAngle", radians(spot.inner_cone_deg)},
                          {"outerConeAngle", radians(spot.outer_cone_deg)}}}});
    return lights;
  }

  // Writes all motions as one animation with linear interpolation.
  void addAnimation(Json& json) {
    Json channels = Json::array(), samplers = Json::array();
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      const Motion& motion = scene_.nodes[i].motion;
      if (motion.times_s.empty()) continue;
      const int times = addAccessor(std::span(motion.times_s), "SCALAR", kFloat, /*target=*/0,
                                    {{"min", {motion.times_s.front()}}, {"max", {motion.times_s.back()}}});
      const auto add = [&](const char* path, int values) {
        channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", i}, {"path", path}}}});
        samplers.push_back({{"input", times}, {"interpolation", "LINEAR"}, {"output", values}});
      };
      if (!motion.translations.empty())
        add("translation", addAccessor(std::span(motion.translations), "VEC3", kFloat, /*target=*/0));
      if (!motion.rotations.empty()) {
        std::vector<glm::vec4> values;
        for (const glm::quat& q : motion.rotations) values.emplace_back(q.x, q.y, q.z, q.w);
        add("rotation", addAccessor(std::span(std::as_const(values)), "VEC4", kFloat, /*target=*/0));
      }
    }
    if (!channels.empty())
      json["animations"] = Json::array(
          {{{"name", scene_.name}, {"channels", std::move(channels)}, {"samplers", std::move(samplers)}}});
  }

  static Json materialJson(const Material& material) {
    const glm::vec3 c = material.base_color;
    Json surface = {{"baseColorFactor", {c.r, c.g, c.b, 1.0f}},
                    {"metallicFactor", material.metallic},
                    {"roughnessFactor", material.roughness}};
    if (material.image >= 0) surface["baseColorTexture"] = {{"index", material.image}};
    Json json = {{"name", material.name},
                 {"pbrMetallicRoughness", surface},
                 {"extensions", {{"KHR_materials_specular", {{"specularFactor", material.specular}}}}}};
    if (material.emission != glm::vec3(0.0f)) {
      const glm::vec3 e = material.emission;
      const float strength = std::max({e.r, e.g, e.b});
      json["emissiveFactor"] = toJson(e / strength);
      json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
    }
    if (material.anisotropy > 0.0f)
      json["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", material.anisotropy}};
    if (material.double_sided) json["doubleSided"] = true;
    return json;
  }

  // Texture i shows image i through the one sampler.
  void addTextures(Json& json) {
    constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kRepeat = 10497;
    Json textures = Json::array(), images = Json::array();
    for (const Image& image : scene_.images) {
      const int view = addView(image.png.data(), image.png.size(), /*target=*/0);
      textures.push_back({{"sampler", 0}, {"source", images.size()}});
      images.push_back({{"name", image.name}, {"mimeType", "image/png"}, {"bufferView", view}});
    }
    json["samplers"] = Json::array({{{"magFilter", kLinear},
                                     {"minFilter", kLinearMipmapLinear},
                                     {"wrapS", kRepeat},
                                     {"wrapT", kRepeat}}});
    json["textures"] = std::move(textures);
    json["images"] = std::move(images);
  }

  static Json extrasJson(const Node& node) {
    Json extras = Json::object();
    if (node.movable) extras["movable"] = true;
    if (node.volume)
      extras["volume"] = {{"file", node.volume->file},
                          {"density_scale", node.volume->density_scale},
                          {"albedo", toJson(node.volume->albedo)},
                          {"size", toJson(node.volume->size)}};
    if (node.neighborhood) {
      const glm::ivec3 size = node.neighborhood->size;
      extras["neighborhood"] = {{"size", {size.x, size.y, size.z}},
                                {"extent", toJson(node.neighborhood->extent)}};
    }
    return extras;
  }

  void addNodes(Json& json) {
    Json nodes = Json::array(), cameras = Json::array(), roots = Json::array();
    for (const Node& node : scene_.nodes) {
      Json item = {{"name", node.name}};
      if (node.mesh >= 0) item["mesh"] = node.mesh;
      if (node.translation != glm::vec3(0.0f)) item["translation"] = toJson(node.translation);
      if (node.rotation != glm::quat(1.0f, 0.0f, 0.0f, 0.0f)) item["rotation"] = toJson(node.rotation);
      if (node.scale != 1.0f) item["scale"] = toJson(glm::vec3(node.scale));
      if (node.spot >= 0) item["extensions"] = {{"KHR_lights_punctual", {{"light", node.spot}}}};
      if (Json extras = extrasJson(node); !extras.empty()) item["extras"] = {{"lambent", std::move(extras)}};
      for (std::size_t child = 0; child < scene_.nodes.size(); ++child)
        if (scene_.nodes[child].parent == static_cast<int>(nodes.size())) item["children"].push_back(child);
      nodes.push_back(std::move(item));
    }
    for (const Camera& camera : scene_.cameras) {
      const glm::mat4 view_from_world = glm::lookAt(camera.eye, camera.target, glm::vec3(0, 1, 0));
      const glm::quat turn = glm::normalize(glm::quat_cast(glm::transpose(glm::mat3(view_from_world))));
      nodes.push_back({{"name", camera.name},
                       {"camera", cameras.size()},
                       {"translation", toJson(camera.eye)},
                       {"rotation", toJson(turn)}});
      const float yfov = camera.yfov_deg * std::numbers::pi_v<float> / 180.0f;
      cameras.push_back({{"name", camera.name},
                         {"type", "perspective"},
                         {"perspective", {{"yfov", yfov}, {"znear", 0.05f}}}});
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (i >= scene_.nodes.size() || scene_.nodes[i].parent < 0) roots.push_back(i);
    json["scenes"] = Json::array({{{"name", scene_.name}, {"nodes", std::move(roots)}}});
    json["nodes"] = std::move(nodes);
    json["cameras"] = std::move(cameras);
  }

  std::string glb(std::string text) const {
    align(text, ' ');
    std::string out;
    const auto word = [&](std::size_t value) {
      static_assert(std::endian::native == std::endian::little);
      const auto narrow = static_cast<std::uint32_t>(value);
      out.append(reinterpret_cast<const char*>(&narrow), sizeof narrow);
    };
    out += "glTF";
    word(2);
    word(12 + 8 + text.size() + 8 + binary_.size());
    word(text.size());
    out += "JSON" + text;
    word(binary_.size());
    out += std::string("BIN\0", 4) + binary_;
    return out;
  }

  const Scene& scene_;
  Json views_ = Json::array(), accessors_ = Json::array();
  std::string binary_;
};

}  // namespace

int addMesh(Scene& scene, const std::string& name, Mesh mesh, int material) {
  scene.meshes.push_back({name, std::move(mesh), material});
  return static_cast<int>(scene.meshes.size()) - 1;
}

void place(Scene& scene, const std::string& name, int mesh, glm::vec3 at, float turn_deg, float scale) {
  const float half = turn_deg * std::numbers::pi_v<float> / 360.0f;
  scene.nodes.push_back({name, mesh, at, glm::quat(std::cos(half), 0.0f, std::sin(half), 0.0f), scale});
}

void show(Scene& scene, const std::string& name, Mesh mesh, int material, glm::vec3 at, float turn_deg,
          float scale) {
  place(scene, name, addMesh(scene, name, std::move(mesh), material), at, turn_deg, scale);
}

void setMotion(Node& node, Motion motion) {
  node.translation = motion.translations.front();
  if (!motion.rotations.empty()) node.rotation = motion.rotations.front();
  node.motion = std::move(motion);
}

std::vector<std::uint8_t> squarePng(std::uint32_t side,
                                    const std::function<glm::vec3(std::uint32_t x, std::uint32_t y)>& srgb) {
  spec::Rgba8Image image{side, side, {}};
  image.texels.reserve(std::size_t{4} * side * side);
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const glm::vec3 color = srgb(x, y);
      for (int channel = 0; channel < 3; ++channel)
        image.texels.push_back(static_cast<std::uint8_t>(std::lround(255.0f * color[channel])));
      image.texels.push_back(255);
    }
  return spec::encodePng(image);
}

Result<void> writeGlb(const std::filesystem::path& path, const Scene& scene) {
  Result<AtomicFile> file = AtomicFile::open(path);
  if (!file) return failAgain(std::move(file.error()));
  if (Result<void> written = file->write(Writer(scene).write()); !written) return written;
  return file->commit();
}

}  // namespace lambent::assets
