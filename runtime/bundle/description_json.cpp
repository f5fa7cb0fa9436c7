#include "runtime/bundle/description_json.hpp"

#include "runtime/base/payload_bytes.hpp"
#include "runtime/bundle/json_fields.hpp"

namespace lambent::bundle {

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
