// Decodes and encodes pictures in memory.

#include "baker/import/openimageio/module.hpp"

#include <algorithm>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vector_relational.hpp>

namespace lambent::baker {

namespace {

constexpr int kLargestSide = 1 << 15;

// OpenImageIO's words may have several lines.
std::string inOneLine(std::string words) {
  std::ranges::replace(words, '\n', ' ');
  return words;
}

Result<std::vector<std::uint8_t>> encode(const Pixels& picture, const std::string& name,
                                         const std::string& compression, const std::string& subject) {
  std::vector<std::uint8_t> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height),
                       static_cast<int>(picture.channels), OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", compression);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const auto output = OIIO::ImageOutput::create(name, &memory);
  if (!output || !output->set_ioproxy(&memory) || !output->open(name, spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, picture.values.data()) || !output->close())
    return fail(subject, "cannot be encoded: " + (output ? output->geterror() : OIIO::geterror()));
  return bytes;
}

Result<Pixels> decode(std::span<const std::byte> file, const std::string& name, const std::string& subject) {
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(file.data()), file.size());
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);  // glTF colours are not premultiplied by alpha
  // The reader takes its bytes from the configuration, because open() forgets the proxy if it gets both.
  OIIO::Filesystem::IOProxy* proxy = &memory;
  wanted.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(name, &wanted);
  if (!input)
    return fail(subject, fmt::format("cannot be decoded ({})", inOneLine(OIIO::geterror())),
                "save it again as PNG or JPEG");

  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.width > kLargestSide || spec.height > kLargestSide ||
      spec.nchannels < 1)
    return fail(subject, fmt::format("has {} x {} pixels", spec.width, spec.height),
                "save it again in a usual size");
  Pixels out{.width = static_cast<std::uint32_t>(spec.width),
             .height = static_cast<std::uint32_t>(spec.height),
             .channels = static_cast<std::uint32_t>(spec.nchannels),
             .values = {}};
  out.values.resize(std::size_t{out.width} * out.height * out.channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, out.values.data()))
    return fail(subject, fmt::format("is damaged ({})", inOneLine(input->geterror())), "save it again");
  return out;
}

Result<std::vector<std::uint8_t>> encodeJpeg(const Pixels& picture, int quality, const std::string& subject) {
  return encode(picture, "picture.jpg", fmt::format("jpeg:{}", quality), subject);
}

Result<std::vector<std::uint8_t>> encodePng(const Pixels& picture, const std::string& subject) {
  return encode(picture, "picture.png", "zip:6", subject);
}

// Reads OpenVDB files as OpenImageIO presents them: a subimage for each grid, its "pixels" in tiles over the
// box of all leaf nodes, and the full (display) window over the box of active voxels. Index coordinates are
// whole numbers at voxel centres; openvdb:indextoworld maps them to the file's space.

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
  std::size_t i = 0;
  glm::i64vec3 at;  // in what is stored
  for (at.z = first.z - stored_min.z; i < grid.values.size(); ++at.z)
    for (at.y = first.y - stored_min.y; at.y < first.y - stored_min.y + size.y; ++at.y)
      for (at.x = first.x - stored_min.x; at.x < first.x - stored_min.x + size.x; ++at.x, ++i)
        if (glm::all(glm::greaterThanEqual(at, glm::i64vec3(0))) && glm::all(glm::lessThan(at, stored)))
          grid.values[i] = all[static_cast<std::size_t>((at.z * stored.y + at.y) * stored.x + at.x)];
  return grid;
}

Result<DensityGrid> readVdbGrid(const std::filesystem::path& file, const std::string& wanted) {
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

}  // namespace

}  // namespace lambent::baker

extern "C" __attribute__((visibility("default"))) const lambent::baker::OpenImageIo lambent_openimageio;

const lambent::baker::OpenImageIo lambent_openimageio = {.decode = lambent::baker::decode,
                                                         .encodeJpeg = lambent::baker::encodeJpeg,
                                                         .encodePng = lambent::baker::encodePng,
                                                         .readVdb = lambent::baker::readVdbGrid};
