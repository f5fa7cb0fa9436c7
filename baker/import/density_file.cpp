// Reads NRRD files (teem.sourceforge.net/nrrd/format.html): a text header up to the first empty line, then
// the values. It accepts three dimensions, one value per voxel, raw encoding and data in the same file;
// anything else is refused with an error that says what it is.

#include "baker/import/density_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <sys/resource.h>

#include "baker/import/openimageio/module.hpp"
#include "baker/import/scene_files.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/base/process.hpp"

namespace lambent::baker {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> wordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

template <typename Number>
Number numberOf(std::string_view text, const char* field) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  bool good = error == std::errc{} && end == text.data() + text.size();
  if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
  if (!good) refuse("its field \"{}\" has \"{}\", which is not a number", field, text.substr(0, 40));
  return value;
}

// Parses a vector such as "(1,0,0)".
glm::dvec3 vectorOf(std::string_view text, const char* field) {
  glm::dvec3 vector(0.0);
  if (text.size() < 2 || text.front() != '(' || text.back() != ')')
    refuse("its field \"{}\" has \"{}\", which is not a vector", field, text.substr(0, 40));
  text = text.substr(1, text.size() - 2);
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (axis == 2))
      refuse("its field \"{}\" has a vector that is not of three numbers", field);
    vector[axis] = numberOf<double>(trimmed(text.substr(0, comma)), field);
    if (axis < 2) text.remove_prefix(comma + 1);
  }
  return vector;
}

class Header {
 public:
  // Takes the header off the front of the file.
  explicit Header(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (!text.starts_with("NRRD000"))
      throw Error{{}, "does not begin like an NRRD file", "name a .nrrd file"};
    for (bool first = true;; first = false) {
      const std::size_t end = text.find('\n', size_);
      if (end == std::string_view::npos) refuse("ends within its header");
      const std::string_view line = trimmed(text.substr(size_, end - size_));
      size_ = end + 1;
      if (line.empty()) return;
      if (!first) add(line);
    }
  }

  std::size_t size() const { return size_; }
  std::optional<std::string_view> find(const std::string& name) const {
    const auto it = fields_.find(name);
    if (it == fields_.end()) return std::nullopt;
    return it->second;
  }
  std::string_view required(const std::string& name) const {
    const auto value = find(name);
    if (!value) refuse("its header has no field \"{}\"", name);
    return *value;
  }

 private:
  void add(std::string_view line) {
    if (line.starts_with('#') || line.find(":=") != std::string_view::npos)
      return;  // comments, and keys of other programs
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos) refuse("its header has the line \"{}\"", line.substr(0, 60));
    if (!fields_.try_emplace(std::string(line.substr(0, colon)), trimmed(line.substr(colon + 1))).second)
      refuse("its header has the field \"{}\" twice", line.substr(0, colon));
  }

  std::size_t size_ = 0;
  std::map<std::string, std::string> fields_;
};

// Returns the three words of a field.
std::vector<std::string_view> triple(std::string_view value, const char* field) {
  auto words = wordsOf(value);
  if (words.size() != 3) refuse("its field \"{}\" is not of three parts", field);
  return words;
}

// Returns file_from_grid: the first voxel's centre, (1/2, 1/2, 1/2), lies at "space origin".
glm::dmat4 fileFromGrid(const Header& header) {
  glm::dmat4 matrix(1.0);
  if (const auto directions = header.find("space directions")) {
    for (int axis = 0; const std::string_view word : triple(*directions, "space directions"))
      matrix[axis++] = glm::dvec4(vectorOf(word, "space directions"), 0.0);
  } else if (const auto spacings = header.find("spacings")) {
    for (int axis = 0; const std::string_view word : triple(*spacings, "spacings"))
      matrix[axis][axis] = numberOf<double>(word, "spacings"), ++axis;
  }
  const glm::dvec4 half = 0.5 * (matrix[0] + matrix[1] + matrix[2]);
  const auto origin = header.find("space origin");
  const glm::dvec3 first = origin ? vectorOf(*origin, "space origin") : glm::dvec3(half);
  matrix[3] = glm::dvec4(first - glm::dvec3(half), 1.0);
  if (!(std::abs(glm::determinant(glm::dmat3(matrix))) > 0.0)) refuse("is flat by its own placement");
  return matrix;
}

template <typename Stored>
std::vector<float> valuesOf(std::span<const std::byte> bytes, bool swapped) {
  std::vector<float> values(bytes.size() / sizeof(Stored));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::array<std::byte, sizeof(Stored)> one;
    std::memcpy(one.data(), &bytes[i * sizeof(Stored)], sizeof(Stored));
    if (swapped) std::ranges::reverse(one);
    values[i] = static_cast<float>(std::bit_cast<Stored>(one));
  }
  return values;
}

struct ValueType {
  std::size_t width;
  std::vector<float> (*values)(std::span<const std::byte> bytes, bool swapped);
};

template <typename Stored>
constexpr ValueType kType = {sizeof(Stored), valuesOf<Stored>};

ValueType typeOf(std::string_view name) {
  static constexpr std::pair<std::string_view, ValueType> kNames[] = {
      {"float", kType<float>},
      {"double", kType<double>},
      {"uchar", kType<std::uint8_t>},
      {"unsigned char", kType<std::uint8_t>},
      {"uint8", kType<std::uint8_t>},
      {"uint8_t", kType<std::uint8_t>},
      {"ushort", kType<std::uint16_t>},
      {"unsigned short", kType<std::uint16_t>},
      {"unsigned short int", kType<std::uint16_t>},
      {"uint16", kType<std::uint16_t>},
      {"uint16_t", kType<std::uint16_t>}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  throw Error{
      {}, fmt::format("has values of the type \"{}\"", name), "save it as float, double, uchar or ushort"};
}

DensityGrid readValues(std::span<const std::byte> file, const std::string& subject) {
  const Header header(file);
  if (numberOf<std::uint32_t>(header.required("dimension"), "dimension") != 3)
    refuse("has {} dimensions, not 3", header.required("dimension"));
  for (const char* elsewhere : {"data file", "datafile", "line skip", "lineskip", "byte skip", "byteskip"})
    if (header.find(elsewhere))
      refuse("has the field \"{}\": only values that follow the header are read", elsewhere);
  if (header.required("encoding") != "raw") refuse("has the encoding \"{}\"", header.required("encoding"));
  const ValueType type = typeOf(header.required("type"));
  bool swapped = false;
  if (type.width > 1) {
    const std::string_view endian = header.required("endian");
    if (endian != "little" && endian != "big") refuse("has the byte order \"{}\"", endian);
    swapped = (endian == "little") != (std::endian::native == std::endian::little);
  }
  glm::u64vec3 size;
  for (int axis = 0; const std::string_view word : triple(header.required("sizes"), "sizes"))
    size[axis++] = numberOf<std::uint32_t>(word, "sizes");
  orThrow(checkGridSize(size, subject));

  const std::uint64_t wanted = size.x * size.y * size.z * type.width, there = file.size() - header.size();
  if (there != wanted)
    throw Error{{},
                fmt::format("has {} bytes of values where its sizes ask for {}", there, wanted),
                "take it from its source again"};
  return {.name = {},
          .size = glm::uvec3(size),
          .values = type.values(file.subspan(header.size()), swapped),
          .file_from_grid = fileFromGrid(header)};
}

}  // namespace

Result<DensityGrid> readNrrd(const std::filesystem::path& file) {
  return resultOf(file.string(), "read", "save it as NRRD of three dimensions with raw encoding",
                  [&] { return readValues(readBytes(file, file.string()), file.string()); });
}

namespace {

// Limits the memory of the program while a library reads a file that it does not check.

// While it lives, the program's address space grows by at most so many bytes, and an allocation beyond that
// throws std::bad_alloc. This holds for all threads, so `more_bytes` must leave them room; only one thread at
// a time has a limit. Where the system refuses a limit there is none.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t more_bytes) : alone_(oneAtATime()) {
    const std::uint64_t now = addressSpaceBytes();
    if (now == 0 || ::getrlimit(RLIMIT_AS, &before_) != 0) return;
    ::rlimit limit = before_;
    limit.rlim_cur = std::min<::rlim_t>(before_.rlim_cur, now + more_bytes);
    set_ = ::setrlimit(RLIMIT_AS, &limit) == 0;
  }
  ~MemoryLimit() {
    if (set_) ::setrlimit(RLIMIT_AS, &before_);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  static std::mutex& oneAtATime() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> alone_;
  ::rlimit before_{};
  bool set_ = false;
};

// OpenVDB believes sizes that a damaged file names. An intact fog volume takes up to some hundred times its
// bytes as trees and again as voxels.
constexpr std::uint64_t kLeastRoom = std::uint64_t{1} << 30, kMostRoom = std::uint64_t{6} << 30;
constexpr std::uint64_t kRoomPerByte = 1000;

}  // namespace

Result<DensityGrid> readVdb(const std::filesystem::path& file, const std::string& grid) {
  return resultOf(file.string(), "read", "take it from its source again", [&] {
    orThrow(checkRegularFile(file, "a .vdb file"));
    const OpenImageIo& reader = *orThrow(openImageIo());
    std::error_code ignored;
    const std::uint64_t bytes = std::filesystem::file_size(file, ignored);
    const MemoryLimit limit(std::clamp(bytes * kRoomPerByte, kLeastRoom, kMostRoom));
    return orThrow(reader.readVdb(file, grid));
  });
}

}  // namespace lambent::baker
