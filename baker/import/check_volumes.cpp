// Checks extras.lambent.volume and extras.lambent.neighborhood of nodes (docs/authoring.md).
#include <cmath>

#include "baker/import/check_fields.hpp"

namespace lambent::baker {
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
  const nlohmann::json* extras = node.find("extras");
  if (extras == nullptr || !extras->is_object() || !extras->contains("lambent")) return;
  const nlohmann::json& ours = (*extras)["lambent"];
  if (!ours.is_object()) return;
  const Object lambent{ours, node.name + ": extras: lambent"};
  if (const auto volume = lambent.object("volume")) checkVolume(*volume);
  if (const auto request = lambent.object("neighborhood")) checkNeighborhood(*request);
}

}  // namespace lambent::baker
