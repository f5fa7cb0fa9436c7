#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/import/check.hpp"

namespace lambent::baker {

std::size_t componentBytes(std::uint64_t component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;  // byte, unsigned byte
    case 5122:
    case 5123:
      return 2;  // short, unsigned short
    case 5125:
    case 5126:
      return 4;  // unsigned int, float
    default:
      return 0;
  }
}

std::size_t componentsOf(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kTypes{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [known, components] : kTypes)
    if (known == type) return components;
  return 0;
}

namespace {

// This limits accessors without a bufferView (all zeros), since such a claim costs a file nothing.
constexpr std::uint64_t kMaxImplicitCount = 1u << 24;
// Returns the bytes of one element; columns of matrices start at multiples of four.
std::uint64_t elementBytes(const std::string& type, std::uint64_t component) {
  const std::uint64_t components = componentsOf(type);
  if (components == 0 || !type.starts_with("MAT")) return components * component;
  const auto columns = static_cast<std::uint64_t>(type.back() - '0');
  return columns * ((columns * component + 3) / 4 * 4);
}

// Checks that `count` elements of `element` bytes fit at byteOffset of the object's bufferView.
void checkExtent(const Object& object, const Root& root, std::uint64_t count, std::uint64_t element,
                 bool strided) {
  const auto index = object.index("bufferView", root.size("bufferViews"), "bufferViews");
  if (!index) throw BrokenField{fmt::format("{} has no bufferView", object.name)};
  const Object view{root.object.list("bufferViews")[*index], fmt::format("bufferView {}", *index)};
  const std::uint64_t offset = object.number("byteOffset").value_or(0);
  const std::uint64_t available = view.required("byteLength");
  const std::uint64_t stride = strided ? view.number("byteStride").value_or(element) : element;
  if (stride < element)
    throw BrokenField{
        fmt::format("{}: byteStride {} is less than an element of {} bytes", object.name, stride, element)};
  // This divides because count * stride may exceed 2^64.
  const bool fits = offset <= available && element <= available - offset &&
                    (count - 1) <= (available - offset - element) / stride;
  if (!fits)
    throw BrokenField{fmt::format("{}: {} elements do not fit the {} bytes of {}", object.name, count,
                                  available, view.name)};
}

void checkSparse(const Object& sparse, const Root& root, std::uint64_t count, std::uint64_t element) {
  const std::uint64_t replaced = sparse.required("count");
  if (replaced == 0 || replaced > count)
    throw BrokenField{fmt::format("{}: replaces {} of {} elements", sparse.name, replaced, count)};
  const auto indices = sparse.object("indices"), values = sparse.object("values");
  if (!indices || !values) throw BrokenField{fmt::format("{} has no indices or no values", sparse.name)};
  const std::uint64_t type = indices->required("componentType");
  if (type != 5121 && type != 5123 && type != 5125)
    throw BrokenField{fmt::format("{}: componentType {} is no index type", indices->name, type)};
  checkExtent(*indices, root, replaced, componentBytes(type), /*strided=*/false);
  checkExtent(*values, root, replaced, element, /*strided=*/false);
}

}  // namespace

void checkView(const Object& view, const Root& root) {
  const auto buffer = view.index("buffer", root.size("buffers"), "buffers");
  if (!buffer) throw BrokenField{fmt::format("{} has no buffer", view.name)};
  const std::uint64_t available =
      Object{root.object.list("buffers")[*buffer], fmt::format("buffer {}", *buffer)}.required("byteLength");
  const std::uint64_t offset = view.number("byteOffset").value_or(0);
  const std::uint64_t length = view.required("byteLength");
  if (offset > available || length > available - offset)
    throw BrokenField{fmt::format("{} reaches from byte {} to {} of a buffer of {} bytes", view.name, offset,
                                  offset + length, available)};
  view.number("byteStride");
  checkMeshopt(view, root);
}

void checkAccessor(const Object& accessor, const Root& root) {
  const std::uint64_t component = componentBytes(accessor.required("componentType"));
  if (component == 0) throw BrokenField{fmt::format("{} has an unknown componentType", accessor.name)};
  const std::uint64_t element = elementBytes(accessor.text("type"), component);
  if (element == 0) throw BrokenField{fmt::format("{} has an unknown type", accessor.name)};
  const std::uint64_t count = accessor.required("count");
  if (count == 0) return;
  if (accessor.find("bufferView") != nullptr) {
    checkExtent(accessor, root, count, element, /*strided=*/true);
  } else if (count > kMaxImplicitCount) {
    throw BrokenField{fmt::format("{} claims {} elements without a bufferView", accessor.name, count)};
  }
  if (const auto sparse = accessor.object("sparse")) checkSparse(*sparse, root, count, element);
}

void checkBuffers(const Root& root) {
  root.forEach("buffers", "buffer", [](const Object& buffer) {
    buffer.required("byteLength");
    buffer.text("uri");
  });
  root.forEach("bufferViews", "bufferView", [&](const Object& view) { checkView(view, root); });
  root.forEach("accessors", "accessor", [&](const Object& accessor) { checkAccessor(accessor, root); });
}

// Checks modes, strides and filters as the extension specifies them; the decoders rely on this.
void checkMeshopt(const Object& view, const Root& root) {
  const auto extensions = view.object("extensions");
  const auto coded = extensions ? extensions->object(kMeshopt) : std::nullopt;
  if (!coded) return;
  const auto buffer = coded->index("buffer", root.size("buffers"), "buffers");
  if (!buffer) throw BrokenField{fmt::format("{} has no buffer", coded->name)};
  const std::uint64_t available =
      Object{root.object.list("buffers")[*buffer], fmt::format("buffer {}", *buffer)}.required("byteLength");
  const std::uint64_t offset = coded->number("byteOffset").value_or(0),
                      length = coded->required("byteLength");
  if (length == 0 || offset > available || length > available - offset)
    throw BrokenField{fmt::format("{} reaches out of buffer {}", coded->name, *buffer)};

  const std::uint64_t stride = coded->required("byteStride"), count = coded->required("count");
  if (stride == 0 || stride > 256 || count == 0 || count > view.required("byteLength") / stride ||
      count * stride != view.required("byteLength"))
    throw BrokenField{
        fmt::format("{}: {} elements of {} bytes are not its bytes", coded->name, count, stride)};
  const std::string mode = coded->text("mode"), filter = coded->text("filter");
  const bool indices = mode == "TRIANGLES" || mode == "INDICES";
  if (!(mode == "ATTRIBUTES" && stride % 4 == 0) && !(indices && (stride == 2 || stride == 4)))
    throw BrokenField{
        fmt::format("{}: mode \"{}\" does not go with a stride of {}", coded->name, mode, stride)};
  if (mode == "TRIANGLES" && count % 3 != 0)
    throw BrokenField{fmt::format("{} is not whole triangles", coded->name)};
  const bool filter_fits =
      filter.empty() || filter == "NONE" ||
      (mode == "ATTRIBUTES" && ((filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                                (filter == "QUATERNION" && stride == 8) || filter == "EXPONENTIAL"));
  if (!filter_fits)
    throw BrokenField{fmt::format("{}: filter \"{}\" does not go with it", coded->name, filter)};
}

namespace {

void checkIndices(const Object& object, const char* key, std::size_t size) {
  for (const nlohmann::json& entry : object.list(key))
    if (object.toNumber(entry, key) >= size)
      throw BrokenField{
          fmt::format("{}: node {} does not exist (there are {})", object.name, entry.dump(), size)};
}

// Requires a forest: every node has at most one parent, and there are no cycles.
void checkForest(const Root& root) {
  const std::size_t size = root.size("nodes");
  std::vector<std::size_t> parent(size, size);
  std::size_t n = 0;
  root.forEach("nodes", "node", [&](const Object& node) {
    for (const nlohmann::json& entry : node.list("children")) {
      const auto child = entry.get<std::size_t>();
      if (parent[child] != size)
        throw BrokenField{
            fmt::format("node {} is a child of node {} and of node {}", child, parent[child], n),
            "give each node one parent"};
      parent[child] = n;
    }
    ++n;
  });
  // 0 means not seen, 1 on the way up from the current start, 2 known to end at a root.
  std::vector<std::uint8_t> state(size, 0);
  for (std::size_t start = 0; start < size; ++start) {
    std::size_t i = start;
    while (i != size && state[i] == 0) {
      state[i] = 1;
      i = parent[i];
    }
    if (i != size && state[i] == 1)
      throw BrokenField{fmt::format("node {} is its own ancestor", i), "break the circle of nodes"};
    for (i = start; i != size && state[i] == 1; i = parent[i]) state[i] = 2;
  }
}

void checkAnimation(const Object& animation, const Root& root) {
  const auto named = [&](const char* what, std::size_t i) {
    return fmt::format("{}, {} {}", animation.name, what, i);
  };
  animation.text("name");
  std::size_t i = 0;
  for (const nlohmann::json& entry : animation.list("samplers")) {
    const Object sampler{entry, named("sampler", i++)};
    for (const char* key : {"input", "output"})
      if (!sampler.index(key, root.size("accessors"), "accessors"))
        throw BrokenField{fmt::format("{} has no {}", sampler.name, key)};
    const std::string word = sampler.text("interpolation");
    if (!word.empty() && word != "LINEAR" && word != "STEP" && word != "CUBICSPLINE")
      throw BrokenField{fmt::format("{} has the unknown interpolation \"{}\"", sampler.name, word)};
  }
  std::size_t c = 0;
  for (const nlohmann::json& entry : animation.list("channels")) {
    const Object channel{entry, named("channel", c++)};
    if (!channel.index("sampler", i, "samplers"))
      throw BrokenField{fmt::format("{} has no sampler", channel.name)};
    const auto target = channel.object("target");
    if (!target) throw BrokenField{fmt::format("{} has no target", channel.name)};
    target->index("node", root.size("nodes"), "nodes");
    target->text("path");
  }
}

void checkSkin(const Object& skin, const Root& root) {
  if (skin.list("joints").empty()) throw BrokenField{fmt::format("{} has no joints", skin.name)};
  checkIndices(skin, "joints", root.size("nodes"));
  skin.index("inverseBindMatrices", root.size("accessors"), "accessors");
}

}  // namespace

void checkNumbers(const Object& object, const char* key, std::size_t count) {
  const nlohmann::json* values = object.find(key);
  if (values == nullptr) return;
  bool good = values->is_array() && (count == 0 || values->size() == count);
  for (std::size_t i = 0; good && i < values->size(); ++i)
    good = (*values)[i].is_number() && std::isfinite((*values)[i].get<float>());
  if (good) return;
  if (count == 0) throw BrokenField{fmt::format("{}: {} is not a list of finite numbers", object.name, key)};
  throw BrokenField{fmt::format("{}: {} is not {} finite numbers", object.name, key, count)};
}

void checkNodes(const Root& root) {
  const std::size_t nodes = root.size("nodes");
  root.forEach("nodes", "node", [&](const Object& node) {
    node.index("mesh", root.size("meshes"), "meshes");
    node.index("camera", root.size("cameras"), "cameras");
    node.index("skin", root.size("skins"), "skins");
    node.text("name");
    checkIndices(node, "children", nodes);
    checkNumbers(node, "matrix", 16);
    checkNumbers(node, "translation", 3);
    checkNumbers(node, "rotation", 4);
    checkNumbers(node, "scale", 3);
    checkNumbers(node, "weights");
    checkNodeExtensions(node, root);
    checkNodeGrids(node);
  });
  checkForest(root);
  root.forEach("scenes", "scene", [&](const Object& scene) { checkIndices(scene, "nodes", nodes); });
  root.object.index("scene", root.size("scenes"), "scenes");
  root.forEach("animations", "animation", [&](const Object& animation) { checkAnimation(animation, root); });
  root.forEach("skins", "skin", [&](const Object& skin) { checkSkin(skin, root); });
}

// Checks extras.lambent.volume and extras.lambent.neighborhood of nodes (docs/authoring.md).

namespace {

void checkReal(const Object& object, const char* key, double above, double below) {
  const nlohmann::json* value = object.find(key);
  if (value == nullptr) return;
  const bool number = value->is_number() && std::isfinite(value->get<double>());
  if (!number || value->get<double>() < above || value->get<double>() > below)
    throw BrokenField{
        fmt::format("{}: {} is {}, not between {} and {}", object.name, key, value->dump(), above, below),
        "correct it"};
}

void checkList(const Object& object, const char* key, double above, double below) {
  checkNumbers(object, key, 3);
  for (const nlohmann::json& value : object.list(key))
    if (value.get<double>() < above || value.get<double>() > below)
      throw BrokenField{
          fmt::format("{}: {} has {}, not between {} and {}", object.name, key, value.dump(), above, below),
          "correct it"};
}

constexpr double kLargestNumber = 1e12, kSmallestNumber = 1e-12;

void checkVolume(const Object& volume) {
  if (volume.text("file").empty())
    throw BrokenField{fmt::format("{} names no file", volume.name),
                      "name a .vdb or .nrrd file beside the scene"};
  volume.text("grid");
  checkReal(volume, "density_scale", 0.0, kLargestNumber);
  checkList(volume, "albedo", 0.0, 1.0);
  checkReal(volume, "g", -0.99, 0.99);
  checkList(volume, "size", kSmallestNumber, kLargestNumber);
}

void checkNeighborhood(const Object& request) {
  constexpr std::uint64_t kMostPoints = 256;
  const auto& size = request.list("size");
  if (request.find("size") != nullptr && size.size() != 3)
    throw BrokenField{fmt::format("{}: size is not three numbers", request.name), "correct it"};
  for (const nlohmann::json& entry : size)
    if (const std::uint64_t points = request.toNumber(entry, "size"); points < 2 || points > kMostPoints)
      throw BrokenField{fmt::format("{}: size has {}, not 2 to {} points", request.name, points, kMostPoints),
                        "correct it"};
  checkList(request, "extent", kSmallestNumber, kLargestNumber);
}

}  // namespace

void checkNodeGrids(const Object& node) {
  // `extras` may be anything; only the object under our own name is checked.
  const nlohmann::json& ours = memberOf(node.json, {"extras", "lambent"});
  if (!ours.is_object()) return;
  const Object lambent{ours, node.name + ": extras: lambent"};
  if (const auto volume = lambent.object("volume")) checkVolume(*volume);
  if (const auto request = lambent.object("neighborhood")) checkNeighborhood(*request);
}

}  // namespace lambent::baker
