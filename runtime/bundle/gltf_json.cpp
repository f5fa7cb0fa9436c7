// Writes and reads the JSON of a bundle, of which any viewer can read the glTF 2.0 part. Materials,
// animations and the extension have files of their own (description_json.hpp).
#include <algorithm>
#include <array>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "runtime/base/payload_bytes.hpp"
#include "runtime/bundle/description_json.hpp"

namespace lambent::bundle {

namespace {

constexpr std::uint64_t kLargestCount = 0xffffffffu;
constexpr const char* kPunctualLights = "KHR_lights_punctual";
constexpr std::array kCameraTypes = {"orthographic", "perspective"};
constexpr std::array kLightTypes = {"directional", "point", "spot"};

// --- meshes ---

// Accessors of a Draco primitive have no bufferView; they only describe what the decoder returns.
Json accessorJson(int component_type, const char* type, std::uint32_t count) {
  return {{"componentType", component_type}, {"type", type}, {"count", count}};
}

struct AttributeName {
  const char* name;
  std::int32_t DracoAttributes::*id;
  int component_type;
  const char* type;
  bool normalized = false;
};
constexpr std::array kAttributes = {
    AttributeName{"POSITION", &DracoAttributes::position, 5126, "VEC3"},
    AttributeName{"NORMAL", &DracoAttributes::normal, 5126, "VEC3"},
    AttributeName{"TEXCOORD_0", &DracoAttributes::texcoord0, 5126, "VEC2"},
    AttributeName{"TEXCOORD_1", &DracoAttributes::texcoord1, 5126, "VEC2"},
    AttributeName{"COLOR_0", &DracoAttributes::color0, 5123, "VEC4", true},
    AttributeName{"TANGENT", &DracoAttributes::tangent, 5126, "VEC4"},
    AttributeName{"_NORMAL_WEIGHT", &DracoAttributes::normal_weight, 5121, "SCALAR", true},
};

Json primitiveJson(const Primitive& primitive, Json& accessors) {
  Json attributes = Json::object(), draco = Json::object();
  for (const AttributeName& attribute : kAttributes) {
    const std::int32_t id = primitive.attributes.*attribute.id;
    if (id < 0) continue;
    Json accessor = accessorJson(attribute.component_type, attribute.type, primitive.vertex_count);
    if (attribute.id == &DracoAttributes::position) {
      accessor["min"] = vectorJson(primitive.bounds_min);
      accessor["max"] = vectorJson(primitive.bounds_max);
    }
    if (attribute.normalized) accessor["normalized"] = true;
    attributes[attribute.name] = accessors.size();
    draco[attribute.name] = id;
    accessors.push_back(std::move(accessor));
  }
  Json json = {{"attributes", attributes}, {"indices", accessors.size()}, {"mode", 4}};
  accessors.push_back(accessorJson(5125, "SCALAR", primitive.index_count));
  if (primitive.material >= 0) json["material"] = primitive.material;
  json["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", primitive.view}, {"attributes", draco}};
  json["extensions"][std::string(kExtensionName)] = {{"digest", hexJson(primitive.digest)},
                                                     {"vectorArea", vectorJson(primitive.vector_area)}};
  return json;
}

Primitive readPrimitive(const Field& field, const std::vector<Field>& accessors, const Description& d) {
  Primitive primitive;
  const Field draco = field["extensions"]["KHR_draco_mesh_compression"];
  primitive.view = draco["bufferView"].index(d.views.size());
  for (const AttributeName& attribute : kAttributes)
    if (draco["attributes"].has(attribute.name))
      primitive.attributes.*attribute.id =
          static_cast<std::int32_t>(draco["attributes"][attribute.name].count(255));
  if (field.has("material"))
    primitive.material = static_cast<std::int32_t>(field["material"].index(d.materials.size()));
  const Field& position = accessors[field["attributes"]["POSITION"].index(accessors.size())];
  primitive.vertex_count = static_cast<std::uint32_t>(position["count"].count(kLargestCount));
  primitive.bounds_min = position["min"].vector<glm::vec3>();
  primitive.bounds_max = position["max"].vector<glm::vec3>();
  const Field& indices = accessors[field["indices"].index(accessors.size())];
  primitive.index_count = static_cast<std::uint32_t>(indices["count"].count(kLargestCount));
  const Field own = field["extensions"][std::string(kExtensionName).c_str()];
  primitive.digest = own["digest"].hex64();
  primitive.vector_area = own["vectorArea"].vector<glm::vec3>();
  return primitive;
}

// --- nodes ---

// A node without a parent stands relative to the description's origin, in the file to that of the world.
Json nodeJson(const gltf::Node& node, const glm::dvec3& origin) {
  Json json = Json::object();
  if (!node.name.empty()) json["name"] = node.name;
  if (!node.children.empty()) json["children"] = node.children;
  if (node.trs) {  // animation channels need the parts; for other nodes the matrix is exact
    const glm::quat& q = node.trs->rotation;
    json["translation"] = vectorJson(glm::dvec3(node.trs->translation) + origin);
    json["rotation"] = vectorJson(glm::vec4(q.x, q.y, q.z, q.w));
    json["scale"] = vectorJson(node.trs->scale);
  } else if (node.parent_from_node != glm::mat4(1.0f) || origin != glm::dvec3(0.0)) {
    glm::dmat4 parent_from_node(node.parent_from_node);
    parent_from_node[3] += glm::dvec4(origin, 0.0);
    json["matrix"] = valueJson(parent_from_node);
  }
  if (node.mesh >= 0) json["mesh"] = node.mesh;
  if (node.camera >= 0) json["camera"] = node.camera;
  if (node.light >= 0) json["extensions"][kPunctualLights] = {{"light", node.light}};
  if (node.movable) json["extras"]["lambent"]["movable"] = true;
  return json;
}

// Reads the rest of a node whose place among the others is known.
void readNode(const Field& field, const Description& d, gltf::Node& node) {
  const glm::dvec3 origin = node.parent < 0 ? d.origin : glm::dvec3(0.0);
  if (field.has("name")) node.name = field["name"].text();
  glm::dmat4 parent_from_node(1.0);
  if (field.has("matrix")) readValue(field["matrix"], parent_from_node);
  parent_from_node[3] -= glm::dvec4(origin, 0.0);
  node.parent_from_node = glm::mat4(parent_from_node);
  if (field.has("rotation")) {
    const auto q = field["rotation"].vector<glm::vec4>();
    if (std::abs(glm::length(q) - 1.0f) > 1e-3f) field["rotation"].fault("is not a unit quaternion");
    node.trs = gltf::Trs{glm::vec3(field["translation"].vector<glm::dvec3>() - origin),
                         glm::quat(q.w, q.x, q.y, q.z), field["scale"].vector<glm::vec3>()};
    node.parent_from_node = node.trs->matrix();
  }
  if (field.has("mesh")) node.mesh = static_cast<std::int32_t>(field["mesh"].index(d.meshes.size()));
  if (field.has("camera")) node.camera = static_cast<std::int32_t>(field["camera"].index(d.cameras.size()));
  if (field.has("extensions") && field["extensions"].has(kPunctualLights))
    node.light =
        static_cast<std::int32_t>(field["extensions"][kPunctualLights]["light"].index(d.lights.size()));
  node.movable = field.has("extras") && field["extras"].has("lambent") &&
                 field["extras"]["lambent"].has("movable") && field["extras"]["lambent"]["movable"].flag();
}

// Sets parents from children. Throws JsonFault if nodes do not form a forest, since later code chains
// transforms without further checks.
void linkParents(const Field& document, std::vector<gltf::Node>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const std::int32_t child : nodes[i].children) {
      gltf::Node& node = nodes[static_cast<std::size_t>(child)];
      if (node.parent >= 0) document["nodes"].fault(fmt::format("give node {} two parents", child));
      node.parent = static_cast<std::int32_t>(i);
    }
  // With one parent each, a node hangs on a root, or it or an ancestor of it lies on a ring. Then the walk
  // down from all roots does not arrive at it.
  std::vector<std::int32_t> open;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].parent < 0) open.push_back(static_cast<std::int32_t>(i));
  std::size_t arrived = 0;
  for (; !open.empty(); ++arrived) {
    const std::vector<std::int32_t>& children = nodes[static_cast<std::size_t>(open.back())].children;
    open.pop_back();
    open.insert(open.end(), children.begin(), children.end());
  }
  if (arrived < nodes.size()) document["nodes"].fault("form a ring");
}

// --- textures ---

// glTF stores samplers separately from textures; equal samplers share an entry.
std::size_t samplerIndex(const gltf::Sampler& sampler, std::vector<gltf::Sampler>& samplers) {
  const auto found = std::find(samplers.begin(), samplers.end(), sampler);
  if (found == samplers.end()) samplers.push_back(sampler);
  return static_cast<std::size_t>(std::find(samplers.begin(), samplers.end(), sampler) - samplers.begin());
}

// --- cameras and lights ---

void cameraFields(const auto& io, auto& camera) {
  io.name(camera.name);
  io.word("type", camera.perspective, kCameraTypes);
  io.child(kCameraTypes[camera.perspective ? 1 : 0], [&](const auto& lens) {
    lens("znear", camera.znear);
    if (lens.has("zfar", camera.zfar > 0.0f)) lens("zfar", camera.zfar);
    if (camera.perspective) {
      lens("yfov", camera.yfov_rad);
      if (lens.has("aspectRatio", camera.aspect > 0.0f)) lens("aspectRatio", camera.aspect);
    } else {
      lens("xmag", camera.xmag);
      lens("ymag", camera.ymag);
    }
  });
}

void lightFields(const auto& io, auto& light) {
  io.name(light.name);
  io.word("type", light.type, kLightTypes);
  io("color", light.color);
  io.require(light.color.x >= 0.0f && light.color.y >= 0.0f && light.color.z >= 0.0f, "color", "is negative");
  io.notNegative("intensity", light.intensity);
  if (io.has("range", light.range_m > 0.0f)) io.notNegative("range", light.range_m);
  if (light.type != gltf::Light::Type::Spot) return;
  io.child("spot", [&](const auto& spot) {
    spot.notNegative("innerConeAngle", light.inner_cone_rad);
    spot.notNegative("outerConeAngle", light.outer_cone_rad);
  });
  io.require(
      light.inner_cone_rad < light.outer_cone_rad && light.outer_cone_rad <= std::numbers::pi_v<float> / 2,
      "spot", "is not a cone inside a cone of at most 90 degrees");
}

template <typename List, typename ToJson>
void writeList(Json& document, const char* key, const List& list, ToJson to_json) {
  for (const auto& item : list) document[key].push_back(to_json(item));  // glTF forbids empty lists
}

void writeGltf(const Description& d, std::uint64_t binary_bytes, Json& document) {
  document["asset"] = {{"version", "2.0"}, {"generator", d.generator.program + " " + d.generator.version}};
  document["buffers"] = Json::array({{{"byteLength", binary_bytes}}});
  for (const View& view : d.views)
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", view.offset}, {"byteLength", view.length}});
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 0}, {"byteLength", kIntegrityBytes}});

  Json accessors = Json::array();
  writeList(document, "meshes", d.meshes, [&](const Mesh& mesh) {
    Json json = Json::object();
    if (!mesh.name.empty()) json["name"] = mesh.name;
    for (const Primitive& primitive : mesh.primitives)
      json["primitives"].push_back(primitiveJson(primitive, accessors));
    return json;
  });
  // The views of the animations are the last ones.
  std::size_t view = d.views.size() - d.animations.size();
  writeList(document, "animations", d.animations,
            [&](const gltf::Animation& animation) { return animationJson(animation, view++, accessors); });
  if (!accessors.empty()) document["accessors"] = std::move(accessors);

  std::vector<gltf::Sampler> samplers;
  writeList(document, "textures", d.textures, [&](const gltf::Texture& texture) {
    return Json{{"source", texture.image}, {"sampler", samplerIndex(texture.sampler, samplers)}};
  });
  writeList(document, "samplers", samplers, [](const gltf::Sampler& sampler) {
    return Json{{"wrapS", sampler.wrap_s},
                {"wrapT", sampler.wrap_t},
                {"magFilter", sampler.mag_filter},
                {"minFilter", sampler.min_filter}};
  });
  writeList(document, "images", d.images, [](const Image& image) {
    Json json = {{"bufferView", image.view}, {"mimeType", image.mime_type}};
    if (!image.name.empty()) json["name"] = image.name;
    return json;
  });
  std::set<std::string> used{std::string(kExtensionName)};
  writeList(document, "materials", d.materials,
            [&](const gltf::Material& material) { return materialJson(material, used); });
  writeList(document, "cameras", d.cameras, [&](const gltf::Camera& camera) {
    return written(d, [&](const auto& io) { cameraFields(io, camera); });
  });
  if (!d.lights.empty()) {
    writeList(document["extensions"][kPunctualLights], "lights", d.lights, [&](const gltf::Light& light) {
      return written(d, [&](const auto& io) { lightFields(io, light); });
    });
    used.insert(kPunctualLights);
  }
  writeList(document, "nodes", d.nodes, [&](const gltf::Node& node) {
    return nodeJson(node, node.parent < 0 ? d.origin : glm::dvec3(0.0));
  });
  if (!d.roots.empty()) {
    document["scenes"] = Json::array({{{"nodes", d.roots}}});
    document["scene"] = 0;
  }
  if (!d.meshes.empty()) {
    used.insert("KHR_draco_mesh_compression");
    document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  }
  document["extensionsUsed"] = used;
}

void readGltf(const Field& document, std::uint64_t binary_bytes, Description& d) {
  const auto views = document["bufferViews"].items();
  if (views.empty()) document["bufferViews"].fault("is empty");
  for (std::size_t i = 0; i + 1 < views.size(); ++i) {
    View view;
    view.offset = views[i]["byteOffset"].count(binary_bytes);
    view.length = views[i]["byteLength"].count(binary_bytes - view.offset);
    if (view.offset % 8 != 0 || (view.length + 7) / 8 * 8 > binary_bytes - view.offset)
      views[i].fault("does not lie on multiples of 8 bytes");
    d.views.push_back(view);
  }

  const auto samplers = document.list("samplers");
  const auto images = document.list("images");
  for (const Field& image : images)
    d.images.push_back({image.has("name") ? image["name"].text() : "", image["mimeType"].text(),
                        image["bufferView"].index(d.views.size())});
  for (const Field& texture : document.list("textures")) {
    const Field& sampler = samplers[texture["sampler"].index(samplers.size())];
    const auto mode = [&](const char* key) { return static_cast<std::uint32_t>(sampler[key].count(65535)); };
    d.textures.push_back({static_cast<std::int32_t>(texture["source"].index(images.size())),
                          {mode("wrapS"), mode("wrapT"), mode("magFilter"), mode("minFilter")}});
  }
  for (const Field& material : document.list("materials"))
    d.materials.push_back(readMaterial(material, d.textures.size()));
  for (const Field& camera : document.list("cameras"))
    cameraFields(FieldReader(camera, d), d.cameras.emplace_back());
  if (document.has("extensions") && document["extensions"].has(kPunctualLights))
    for (const Field& light : document["extensions"][kPunctualLights].list("lights"))
      lightFields(FieldReader(light, d), d.lights.emplace_back());

  const auto accessors = document.list("accessors");
  for (const Field& field : document.list("meshes")) {
    Mesh mesh;
    if (field.has("name")) mesh.name = field["name"].text();
    for (const Field& primitive : field["primitives"].items())
      mesh.primitives.push_back(readPrimitive(primitive, accessors, d));
    d.meshes.push_back(std::move(mesh));
  }

  const Field extension = document["extensions"][std::string(kExtensionName).c_str()];
  if (extension.has("origin")) d.origin = extension["origin"].vector<glm::dvec3>();
  const auto nodes = document.list("nodes");
  for (const Field& node : nodes)
    for (auto& children = d.nodes.emplace_back().children; const Field& child : node.list("children"))
      children.push_back(static_cast<std::int32_t>(child.index(nodes.size())));
  linkParents(document, d.nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i) readNode(nodes[i], d, d.nodes[i]);
  const auto animations = document.list("animations");
  if (animations.size() > d.views.size()) document["animations"].fault("are more than the bufferViews");
  for (std::size_t i = 0; i < animations.size(); ++i) {
    const std::size_t view = d.views.size() - animations.size() + i;
    d.animations.push_back(readAnimation(animations[i], accessors, view, d.views[view].length, d.nodes));
    for (const gltf::AnimationChannel& channel : d.animations.back().channels) {
      gltf::Node& node = d.nodes[channel.node];
      if (node.parent < 0 && extension.has("origin"))
        nodes[channel.node].fault("is moved by an animation, but stands at the origin");
      node.animated = true;
      if (!node.trs) node.trs = gltf::Trs{};  // readAnimation() has checked that the node has no matrix
    }
  }
  const auto scenes = document.list("scenes");
  if (document.has("scenes") && scenes.empty()) document["scenes"].fault("are none");
  for (std::size_t i = 0; i < std::min<std::size_t>(scenes.size(), 1); ++i)
    for (const Field& root : scenes[i].list("nodes"))
      d.roots.push_back(static_cast<std::int32_t>(root.index(d.nodes.size())));
}

}  // namespace

std::string toJson(const Description& description, std::uint64_t binary_bytes) {
  Json document;
  writeGltf(description, binary_bytes, document);
  document["extensions"][std::string(kExtensionName)] = writeTransfer(description);
  return document.dump();
}

Result<Description> fromJson(const std::string& text, std::uint64_t binary_bytes, const std::string& file) {
  const std::string name(kExtensionName);
  try {
    const Json document = Json::parse(text);
    const Field root(document, "");
    if (!root.has("extensions") || !root["extensions"].has(name.c_str()))
      return fail(file, "is a glTF file without baked transfer", "bake it with `lambent bake`");
    const Field extension = root["extensions"][name.c_str()];
    const std::uint64_t version = extension["version"].count(0xffffffffu);
    if (version > kVersionCurrent)
      return fail(
          file, fmt::format("has format version {}, newer than this program's {}", version, kVersionCurrent),
          "use a newer lambent or bake it again");
    if (version >= kVersionFirstLight && version < kVersionVolumesAndNeighborhoods)
      return fail(file,
                  fmt::format("was written by an older program (format version {}, this one reads {})",
                              version, kVersionCurrent),
                  "bake it again");
    if (version < kVersionFirstLight)
      return fail(file, fmt::format("has the unknown format version {}", version), "bake it again");
    Description description;
    readGltf(root, binary_bytes, description);
    readTransfer(extension, description);
    return description;
  } catch (const JsonFault& fault) {
    return fail(file, fmt::format("is damaged: {}", fault.what()), "bake it again");
  } catch (const Json::exception&) {
    return fail(file, "is damaged: its JSON cannot be read", kCopyAgain);
  }
}

}  // namespace lambent::bundle
