#include "baker/import/meshopt.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "baker/import/check_fields.hpp"
#include "baker/import/hints.hpp"

namespace lambent::baker {

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

Result<void> decodeMeshopt(const nlohmann::json& extension, std::span<const std::byte> coded,
                           std::span<std::byte> view, const std::string& subject, const std::string& object) {
  const auto count = extension["count"].get<std::size_t>(),
             stride = extension["byteStride"].get<std::size_t>();
  const std::string mode = extension["mode"].get<std::string>(), filter = extension.value("filter", "NONE");
  const auto* bytes = reinterpret_cast<const unsigned char*>(coded.data());
  int failed = 0;
  if (mode == "ATTRIBUTES")
    failed = meshopt_decodeVertexBuffer(view.data(), count, stride, bytes, coded.size());
  else if (mode == "TRIANGLES")
    failed = meshopt_decodeIndexBuffer(view.data(), count, stride, bytes, coded.size());
  else
    failed = meshopt_decodeIndexSequence(view.data(), count, stride, bytes, coded.size());
  if (failed != 0)
    return fail(subject,
                fmt::format("{}: its {} bytes are not {} coded by meshoptimizer", object, coded.size(), mode),
                kExportAgain);
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(view.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(view.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(view.data(), count, stride);
  return {};
}

}  // namespace lambent::baker
