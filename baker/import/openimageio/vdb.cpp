// Reads OpenVDB files as OpenImageIO presents them: a subimage for each grid, its "pixels" in tiles over the
// box of all leaf nodes, and the full (display) window over the box of active voxels. Index coordinates are
// whole numbers at voxel centres; openvdb:indextoworld maps them to the file's space.
#include <algorithm>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/import/openimageio/module.hpp"

namespace lambent::baker::openimageio {
namespace {

constexpr const char* kWriteAgain = "write it again as a fog volume of float values";

std::string gridName(const OIIO::ImageSpec& spec) {
  const std::string name = spec.get_string_attribute("openvdb:name");
  return name.empty() ? std::string(spec.get_string_attribute("oiio:subimagename")) : name;
}

// The file has row vectors with the shift in the last row, which is how glm lies in memory too.
Result<glm::dmat4> fileFromIndex(const OIIO::ImageSpec& spec, const std::string& subject) {
  const OIIO::ParamValue* value = spec.find_attribute("openvdb:indextoworld");
  glm::dmat4 matrix(1.0);
  if (value == nullptr || value->type().aggregate != OIIO::TypeDesc::MATRIX44)
    return fail(subject, "has no affine transform from voxels to space", kWriteAgain);
  for (int i = 0; i < 16; ++i)
    matrix[i / 4][i % 4] = value->type().basetype == OIIO::TypeDesc::DOUBLE
                               ? static_cast<const double*>(value->data())[i]
                               : double{static_cast<const float*>(value->data())[i]};
  return matrix;
}

Result<DensityGrid> readVoxels(OIIO::ImageInput& input, const std::string& subject) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.nchannels != 1)
    return fail(subject, fmt::format("has {} values in each voxel", spec.nchannels), kWriteAgain);
  DensityGrid grid;
  grid.name = gridName(spec);
  const glm::i64vec3 stored_min(spec.x, spec.y, spec.z), stored(spec.width, spec.height, spec.depth);
  const glm::i64vec3 first(spec.full_x, spec.full_y, spec.full_z);
  const glm::i64vec3 size(spec.full_width, spec.full_height, spec.full_depth);
  for (int axis = 0; axis < 3; ++axis)
    if (stored[axis] < 1 || size[axis] < 1) return fail(subject, "holds no voxel", kWriteAgain);
  for (const glm::i64vec3& box : {stored, size})
    if (auto checked = checkGridSize(glm::u64vec3(box), subject); !checked) return failAgain(checked.error());
  const auto matrix = fileFromIndex(spec, subject);
  if (!matrix) return failAgain(matrix.error());
  grid.file_from_grid = *matrix * glm::translate(glm::dmat4(1.0), glm::dvec3(first) - 0.5);

  std::vector<float> all(static_cast<std::size_t>(stored.x * stored.y * stored.z));
  if (!input.read_image(input.current_subimage(), 0, 0, 1, OIIO::TypeDesc::FLOAT, all.data()))
    return fail(subject, fmt::format("is damaged ({})", input.geterror()), "take it from its source again");
  // The grid covers the box of active voxels, wherever that lies in what is stored.
  grid.size = glm::uvec3(size);
  grid.values.assign(static_cast<std::size_t>(size.x * size.y * size.z), 0.0f);
  const glm::i64vec3 shift = first - stored_min;
  const std::int64_t begin = std::max<std::int64_t>(0, -shift.x),
                     end = std::min<std::int64_t>(size.x, stored.x - shift.x);
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      const std::int64_t from_y = y + shift.y, from_z = z + shift.z;
      if (from_y < 0 || from_z < 0 || from_y >= stored.y || from_z >= stored.z || begin >= end) continue;
      const auto* row =
          &all[static_cast<std::size_t>((from_z * stored.y + from_y) * stored.x + shift.x + begin)];
      std::copy(row, row + (end - begin),
                &grid.values[static_cast<std::size_t>((z * size.y + y) * size.x + begin)]);
    }
  return grid;
}

}  // namespace

Result<DensityGrid> readVdb(const std::filesystem::path& file, const std::string& wanted) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) {
    const std::string why = OIIO::geterror();
    return fail(file.string(),
                why.find("bad_alloc") == std::string::npos
                    ? fmt::format("cannot be read ({})", why)
                    : "needs far more memory than a file of its size should, as damaged files do",
                "take it from its source again");
  }
  std::vector<std::string> names;
  for (int i = 0; input->seek_subimage(i, 0); ++i) names.push_back(gridName(input->spec()));
  const std::string name = wanted.empty() ? (names.size() == 1 ? names.front() : "density") : wanted;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    return fail(file.string(), fmt::format("has no grid \"{}\"", name),
                fmt::format("it has: {}", fmt::join(names, ", ")));
  input->seek_subimage(static_cast<int>(found - names.begin()), 0);
  return readVoxels(*input, fmt::format("{}: grid \"{}\"", file.string(), name));
}

}  // namespace lambent::baker::openimageio
