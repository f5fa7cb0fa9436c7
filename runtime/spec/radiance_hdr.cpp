// Reads and writes Radiance RGBE pictures. A file has text lines up to an empty one, a line such as "-Y
// height +X width", and then scanlines. A scanline is flat (4 bytes per texel), old run-length coded (1 1 1 n
// repeats) or new run-length coded (2 2 width, then the four components one after the other). G. Ward, "Real
// Pixels", Graphics Gems II, 1991.
//
// Each program that scales a picture adds a line EXPOSURE= or COLORCORR= to what is there, and radiance is
// what all of these factors divide. Radiance's own manual indents the lines of pictures that went into this
// one, and they do not count.
//
// A component is m * 2^(e - 136). Ward's own reader adds half a step (m + 0.5), but common viewers of
// environment maps do not, so the encoder below rounds to nearest.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "runtime/base/atomic_file.hpp"
#include "runtime/spec/image.hpp"
#include "runtime/spec/numbers.hpp"
#include "runtime/spec/rec709.hpp"

namespace lambent::spec {

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

constexpr std::size_t kMinRunWidth = 8, kMaxRunWidth = 0x7fff;  // widths of new run-length coding

glm::vec3 decode(Rgbe rgbe) {
  if (rgbe[3] == 0) return glm::vec3(0.0f);
  const float scale = std::ldexp(1.0f, int{rgbe[3]} - 136);
  return glm::vec3(rgbe[0], rgbe[1], rgbe[2]) * scale;
}

Rgbe encode(glm::vec3 colour) {
  const float largest = std::max({colour.r, colour.g, colour.b});
  int exponent = 0;
  if (largest <= 0.0f || (std::frexp(largest, &exponent), exponent < -127)) return {0, 0, 0, 0};
  float scale = std::ldexp(1.0f, 8 - exponent);
  if (std::lround(largest * scale) > 255) scale = std::ldexp(1.0f, 8 - ++exponent);
  const auto mantissa = [&](float value) { return static_cast<std::uint8_t>(std::lround(value * scale)); };
  return {mantissa(colour.r), mantissa(colour.g), mantissa(colour.b),
          static_cast<std::uint8_t>(exponent + 128)};
}

// Reads the bytes of the file in order. `short_` is set if more are requested than there are.
class Bytes {
 public:
  explicit Bytes(std::string_view text) : text_(text) {}

  std::uint8_t next() {
    if (at_ < text_.size()) return static_cast<std::uint8_t>(text_[at_++]);
    short_ = true;
    return 0;
  }
  Rgbe nextTexel() {
    Rgbe texel;
    for (std::uint8_t& component : texel) component = next();
    return texel;
  }
  // Returns the text up to the next newline, without it.
  std::string_view line() {
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos) {
      short_ = true;
      return {};
    }
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end + 1;
    return found;
  }
  bool ranOut() const { return short_; }
  std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  bool short_ = false;
};

// Reads the four components one after the other. A count over 128 repeats one byte count - 128 times; any
// other count copies that many bytes.
bool readRuns(Bytes& in, std::vector<Rgbe>& scanline) {
  for (std::size_t component = 0; component < 4; ++component) {
    for (std::size_t x = 0; x < scanline.size();) {
      const std::uint8_t code = in.next();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128u : code;
      if (count == 0 || x + count > scanline.size()) return false;
      std::uint8_t value = run ? in.next() : std::uint8_t{0};
      for (std::size_t i = 0; i < count; ++i) {
        if (!run) value = in.next();
        scanline[x++][component] = value;
      }
    }
  }
  return !in.ranOut();
}

bool readScanline(Bytes& in, std::vector<Rgbe>& scanline) {
  const std::size_t width = scanline.size();
  std::size_t x = 0;
  unsigned repeat_shift = 0;
  while (x < width) {
    const Rgbe texel = in.nextTexel();
    if (in.ranOut()) return false;
    const bool new_runs = texel[0] == 2 && texel[1] == 2 && texel[2] < 128;
    if (x == 0 && new_runs && width >= kMinRunWidth && width <= kMaxRunWidth)
      return texel[2] * std::size_t{256} + texel[3] == width && readRuns(in, scanline);
    if (texel[0] == 1 && texel[1] == 1 && texel[2] == 1) {  // old run; successive runs form a larger count
      const std::size_t count = std::size_t{texel[3]} << repeat_shift;
      if (x == 0 || repeat_shift > 16 || count > width - x) return false;
      std::fill_n(scanline.begin() + static_cast<std::ptrdiff_t>(x), count, scanline[x - 1]);
      x += count;
      repeat_shift += 8;
    } else {
      scanline[x++] = texel;
      repeat_shift = 0;
    }
  }
  return true;
}

struct Header {
  std::string_view format = "32-bit_rle_rgbe";
  glm::vec3 scale{1.0f};  // from values in the file to radiance
  std::optional<Primaries> primaries = {};
  std::vector<std::string> notices = {};
};

std::vector<float> numbersIn(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\r";
  std::vector<float> numbers;
  while (text.find_first_not_of(kSpaces) != std::string_view::npos) {
    text.remove_prefix(text.find_first_not_of(kSpaces));
    const std::size_t size = std::min(text.find_first_of(kSpaces), text.size());
    const std::optional<float> number = parseNumber(text.substr(0, size));
    if (!number) return {};
    numbers.push_back(*number);
    text.remove_prefix(size);
  }
  return numbers;
}

// Return false if a line has no usable numbers.
bool takeFactors(const std::vector<float>& factors, std::size_t count, glm::vec3& scale) {
  if (factors.size() != count) return false;
  const glm::vec3 by =
      scale / (count == 1 ? glm::vec3(factors[0]) : glm::vec3(factors[0], factors[1], factors[2]));
  constexpr float kMost = 1e15f;
  for (int channel = 0; channel < 3; ++channel)
    if (!(by[channel] > 1.0f / kMost && by[channel] < kMost)) return false;
  scale = by;
  return true;
}

bool takePrimaries(const std::vector<float>& xy, std::optional<Primaries>& primaries) {
  if (xy.size() != 8) return false;
  if (std::ranges::all_of(xy, [](float value) { return value == 0.0f; })) return true;  // Photoshop: unknown
  const Primaries said{{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
  if (!rec709From(said)) return false;
  primaries = said;
  return true;
}

Header readHeader(Bytes& in) {
  Header header;
  for (std::string_view line = in.line(); !line.empty() && line != "\r"; line = in.line()) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = line.substr(0, equals), value = line.substr(equals + 1);
    if (name == "FORMAT") header.format = value.substr(std::min(value.find_first_not_of(' '), value.size()));
    const bool sense = name == "EXPOSURE"    ? takeFactors(numbersIn(value), 1, header.scale)
                       : name == "COLORCORR" ? takeFactors(numbersIn(value), 3, header.scale)
                       : name == "PRIMARIES" ? takePrimaries(numbersIn(value), header.primaries)
                                             : true;
    if (!sense)
      header.notices.push_back("has no usable numbers in its line \"" + std::string(line) +
                               "\", which is ignored");
  }
  return header;
}

// In which order texels follow one another.
struct Order {
  bool columns = false;  // scanlines are columns of the picture
  bool from_right = false, from_below = false;
  std::uint64_t width = 0, height = 0;
};

// Parses lines such as "-Y 512 +X 1024": y falls from scanline to scanline, x grows along each.
std::optional<Order> parseOrder(std::string_view text) {
  Order order;
  std::string axes;
  for (int axis = 0; axis < 2; ++axis) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (text.size() < 3 || (text[0] != '-' && text[0] != '+')) return std::nullopt;
    const bool falls = text[0] == '-', x = text[1] == 'X';
    axes += text[1];
    text.remove_prefix(2);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    const auto [stop, code] =
        std::from_chars(text.data(), text.data() + text.size(), x ? order.width : order.height);
    if (code != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    (x ? order.from_right : order.from_below) = x ? falls : !falls;
  }
  if (axes != "YX" && axes != "XY") return std::nullopt;
  order.columns = axes == "XY";
  return order;
}

void appendRuns(const std::vector<Rgbe>& scanline, std::size_t component, std::string& out) {
  constexpr std::size_t kLongest = 127, kWorthARun = 4;
  const std::size_t width = scanline.size();
  const auto runAt = [&](std::size_t x) {
    std::size_t end = x + 1;
    while (end < width && end - x < kLongest && scanline[end][component] == scanline[x][component]) ++end;
    return end - x;
  };
  for (std::size_t x = 0; x < width;) {
    if (const std::size_t run = runAt(x); run >= kWorthARun) {
      out += {static_cast<char>(128 + run), static_cast<char>(scanline[x][component])};
      x += run;
      continue;
    }
    std::size_t end = x + 1;
    while (end < width && end - x < kLongest && runAt(end) < kWorthARun) ++end;
    out += static_cast<char>(end - x);
    for (; x < end; ++x) out += static_cast<char>(scanline[x][component]);
  }
}

}  // namespace

Result<RgbImage> readHdr(const std::filesystem::path& path) {
  const Result<std::string> text = readTextFile(path);
  if (!text) return failAgain(text.error());
  Bytes in(*text);
  if (!in.line().starts_with("#?"))
    return fail(path.string(), "is not a Radiance picture", "name a .hdr file");
  Header header = readHeader(in);
  const bool xyze = header.format.starts_with("32-bit_rle_xyze");
  if (!xyze && !header.format.starts_with("32-bit_rle_rgbe"))
    return fail(path.string(), "is neither in RGB nor in XYZ (FORMAT=" + std::string(header.format) + ")",
                "convert it to RGB");
  const std::optional<Order> order = parseOrder(in.line());
  if (!order || in.ranOut())
    return fail(path.string(), "its size line is not as \"-Y height +X width\"", "save it again");
  // New runs need at least 2 bytes for 127 values of each of 4 components. Old runs need 4 bytes for 255 <<
  // 16 texels, but nobody writes them any more, so 4096 texels per byte are generous.
  if (const auto checked = checkImageSize(path, order->width, order->height, in.rest().size(),
                                          /*texels_per_byte=*/4096);
      !checked)
    return failAgain(checked.error());

  const glm::mat3 colors = xyze               ? rec709FromXyz()
                           : header.primaries ? *rec709From(*header.primaries)
                                              : glm::mat3(1.0f);
  const bool converts = colors != glm::mat3(1.0f);
  RgbImage image{static_cast<std::uint32_t>(order->width), static_cast<std::uint32_t>(order->height),
                 std::vector<glm::vec3>(order->width * order->height), std::move(header.notices)};
  const std::uint64_t scanlines = order->columns ? order->width : order->height;
  std::vector<Rgbe> scanline(order->columns ? order->height : order->width);
  for (std::uint64_t line = 0; line < scanlines; ++line) {
    if (!readScanline(in, scanline))
      return fail(path.string(),
                  std::string(in.ranOut() ? "is truncated" : "is damaged") + " in scanline " +
                      std::to_string(line) + " of " + std::to_string(scanlines),
                  "copy or download it again");
    for (std::uint64_t i = 0; i < scanline.size(); ++i) {
      const glm::vec3 color = header.scale * decode(scanline[i]);
      const std::uint64_t right = order->columns ? line : i, down = order->columns ? i : line;
      const std::uint64_t x = order->from_right ? order->width - 1 - right : right,
                          y = order->from_below ? order->height - 1 - down : down;
      image.texels[y * order->width + x] = converts ? colors * color : color;
    }
  }
  return image;
}

Result<void> writeHdr(const std::filesystem::path& path, const RgbImage& image) {
  constexpr float kLargest = 1e38f;
  for (const glm::vec3 texel : image.texels)
    for (int channel = 0; channel < 3; ++channel)
      if (!(texel[channel] >= 0.0f && texel[channel] < kLargest))
        return fail(path.string(), "a texel is negative or not finite, which RGBE cannot hold",
                    "write an .exr");
  std::string out = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) + " +X " +
                    std::to_string(image.width) + "\n";
  std::vector<Rgbe> scanline(image.width);
  const bool runs = image.width >= kMinRunWidth && image.width <= kMaxRunWidth;
  for (std::size_t y = 0; y < image.height; ++y) {
    for (std::size_t x = 0; x < image.width; ++x) scanline[x] = encode(image.texels[y * image.width + x]);
    if (runs) {
      out += {2, 2, static_cast<char>(image.width >> 8), static_cast<char>(image.width & 255)};
      for (std::size_t component = 0; component < 4; ++component) appendRuns(scanline, component, out);
    } else {
      for (const Rgbe texel : scanline)
        for (const std::uint8_t component : texel) out += static_cast<char>(component);
    }
  }
  return writeFile(path, std::as_bytes(std::span(out)));
}

}  // namespace lambent::spec
