#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/import/document.hpp"
#include "baker/import/error_text.hpp"
#include "baker/import/tinygltf.hpp"

namespace lambent::baker {
namespace {

template <typename T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));  // glTF and all supported machines are little-endian
  return value;
}

template <typename T>
float integerToFloat(const unsigned char* bytes, bool normalized) {
  const auto value = static_cast<float>(load<T>(bytes));
  if (!normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

float toFloat(const unsigned char* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return integerToFloat<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return integerToFloat<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return integerToFloat<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return integerToFloat<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return integerToFloat<std::uint32_t>(bytes, normalized);
    default:
      return load<float>(bytes);
  }
}

std::uint32_t toIndex(const unsigned char* bytes, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

// Points to `count` elements of `element` bytes in a bufferView. checkDocument() compared the extents with
// the byteLengths, and the buffers were loaded with exactly these.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;
  const unsigned char* operator[](std::size_t i) const { return first + i * stride; }
};

Elements elementsAt(const Document& document, int view_index, std::size_t offset, std::size_t count,
                    std::size_t element, bool strided) {
  const auto index = static_cast<std::size_t>(view_index);
  const tinygltf::BufferView& view = document.model().bufferViews[index];
  const std::vector<unsigned char>& bytes =
      document.model().buffers[static_cast<std::size_t>(view.buffer)].data;
  const std::size_t stride =
      strided ? document.json()["bufferViews"][index].value("byteStride", element) : element;
  assert(view.byteOffset + offset + (count - 1) * stride + element <= bytes.size());
  static_cast<void>(count);
  return {bytes.data() + view.byteOffset + offset, stride};
}

// Calls replace(target, bytes of the value) for every element that a sparse accessor replaces.
template <typename Replace>
void forEachSparse(const Document& document, const tinygltf::Accessor& accessor, std::size_t element,
                   Replace replace) {
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  const auto index_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(sparse.indices.componentType)));
  const Elements indices =
      elementsAt(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                 count, index_bytes, /*strided=*/false);
  const Elements values =
      elementsAt(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                 count, element, /*strided=*/false);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t target = toIndex(indices[i], sparse.indices.componentType);
    if (target < accessor.count) replace(target, values[i]);  // otherwise there is nothing to replace
  }
}

}  // namespace

Result<Floats> readFloats(const Document& document, int index, const std::string& use,
                          const std::vector<int>& allowed_components, std::size_t components) {
  const tinygltf::Model& model = document.model();
  const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
  const int stored_components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  // MAT2 has four components too, but is not a vector.
  const bool known = (accessor.type <= TINYGLTF_TYPE_VEC4 && accessor.type >= TINYGLTF_TYPE_VEC2) ||
                     accessor.type == TINYGLTF_TYPE_SCALAR || accessor.type == TINYGLTF_TYPE_MAT4;
  if (!known || std::find(allowed_components.begin(), allowed_components.end(), stored_components) ==
                    allowed_components.end())
    return fail(document.file(), fmt::format("accessor {} ({}) has the wrong type", index, use),
                kExportAgain);

  const auto stored = static_cast<std::size_t>(stored_components);
  const std::size_t component_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  Floats floats{std::vector<float>(accessor.count * components, 1.0f), components};
  if (accessor.bufferView >= 0 && accessor.count > 0) {
    const Elements elements = elementsAt(document, accessor.bufferView, accessor.byteOffset, accessor.count,
                                         stored * component_bytes, /*strided=*/true);
    for (std::size_t i = 0; i < accessor.count; ++i)
      for (std::size_t c = 0; c < stored; ++c)
        floats.values[i * components + c] =
            toFloat(elements[i] + c * component_bytes, accessor.componentType, accessor.normalized);
  } else {
    for (std::size_t i = 0; i < accessor.count; ++i)
      for (std::size_t c = 0; c < stored; ++c) floats.values[i * components + c] = 0.0f;
  }
  forEachSparse(document, accessor, stored * component_bytes,
                [&](std::size_t target, const unsigned char* value) {
                  for (std::size_t c = 0; c < stored; ++c)
                    floats.values[target * components + c] =
                        toFloat(value + c * component_bytes, accessor.componentType, accessor.normalized);
                });
  return floats;
}

Result<std::vector<std::uint32_t>> readIndices(const Document& document, int index) {
  const tinygltf::Accessor& accessor = document.model().accessors[static_cast<std::size_t>(index)];
  const int type = accessor.componentType;
  const bool is_index = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                        type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                        type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index)
    return fail(document.file(), fmt::format("accessor {} does not hold unsigned indices", index),
                kExportAgain);
  const auto bytes =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)));
  std::vector<std::uint32_t> indices(accessor.count, 0);
  if (accessor.bufferView >= 0 && accessor.count > 0) {
    const Elements elements = elementsAt(document, accessor.bufferView, accessor.byteOffset, accessor.count,
                                         bytes, /*strided=*/true);
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = toIndex(elements[i], type);
  }
  forEachSparse(document, accessor, bytes, [&](std::size_t target, const unsigned char* value) {
    indices[target] = toIndex(value, type);
  });
  return indices;
}

}  // namespace lambent::baker
