// Reads a field that refers to a payload of the bundle.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/bundle/description.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

// Returns the index of a payload. Throws JsonFault if its type or, if given, its length is another.
inline std::uint32_t payloadIndex(const Field& field, const Description& d, PayloadType type,
                                  std::optional<std::uint64_t> raw_length) {
  const std::uint32_t index = field.index(d.payloads.size());
  if (d.payloads[index].type != type) field.fault("is a payload of another type");
  if (raw_length && d.payloads[index].raw_length != *raw_length) field.fault("is a payload of another size");
  return index;
}

}  // namespace lambent::bundle
