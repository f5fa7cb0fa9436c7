// Decodes and encodes pictures in memory.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "baker/import/openimageio/module.hpp"

namespace lambent::baker::openimageio {
namespace {

constexpr int kLargestSide = 1 << 15;

}  // namespace

Result<Pixels> decode(std::span<const std::byte> file, const std::string& name, const std::string& subject) {
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(file.data()), file.size());
  OIIO::ImageSpec wanted;
  wanted.attribute("oiio:UnassociatedAlpha", 1);  // glTF colours are not premultiplied by alpha
  // The reader takes its bytes from the configuration, because open() forgets the proxy if it gets both.
  OIIO::Filesystem::IOProxy* proxy = &memory;
  wanted.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto input = OIIO::ImageInput::open(name, &wanted);
  if (!input)
    return fail(subject, fmt::format("cannot be decoded ({})", OIIO::geterror()),
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
    return fail(subject, fmt::format("is damaged ({})", input->geterror()), "save it again");
  return out;
}

Result<std::vector<std::uint8_t>> encodeJpeg(const Pixels& picture, int quality, const std::string& subject) {
  constexpr const char* kName = "picture.jpg";
  std::vector<std::uint8_t> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height),
                       static_cast<int>(picture.channels), OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", fmt::format("jpeg:{}", quality));
  const auto output = OIIO::ImageOutput::create(kName, &memory);
  if (!output || !output->set_ioproxy(&memory) || !output->open(kName, spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, picture.values.data()) || !output->close())
    return fail(subject, "cannot be encoded: " + (output ? output->geterror() : OIIO::geterror()));
  return bytes;
}

}  // namespace lambent::baker::openimageio
