#include "baker/import/check_fields.hpp"

namespace lambent::baker {
namespace {

// This limits accessors without a bufferView (all zeros), since such a claim costs a file nothing.
constexpr std::uint64_t kMaxImplicitCount = 1u << 24;
// tinygltf keeps counts and offsets of sparse parts as int.
constexpr std::uint64_t kMaxSparse = 0x7fffffff;

std::uint64_t componentBytes(std::uint64_t component_type) {
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

// Returns the bytes of one element; columns of matrices start at multiples of four.
std::uint64_t elementBytes(const std::string& type, std::uint64_t component) {
  if (type == "SCALAR") return component;
  if (type == "VEC2") return 2 * component;
  if (type == "VEC3") return 3 * component;
  if (type == "VEC4") return 4 * component;
  if (type == "MAT2") return component == 1 ? 8 : 4 * component;
  if (type == "MAT3") return component == 1 ? 12 : component == 2 ? 24 : 9 * component;
  if (type == "MAT4") return 16 * component;
  return 0;
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
  if (!strided && (offset > kMaxSparse || count > kMaxSparse))
    throw BrokenField{fmt::format("{} reaches past 2 GiB", object.name)};
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

}  // namespace lambent::baker
