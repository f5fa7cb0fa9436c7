// Decodes and encodes pictures in memory.
#include <algorithm>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "baker/import/openimageio/module.hpp"

namespace lambent::baker::openimageio {
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

}  // namespace lambent::baker::openimageio
