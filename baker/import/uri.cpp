#include "baker/import/uri.hpp"

#include <charconv>
#include <system_error>

#include <fmt/format.h>

namespace lambent::baker {

std::string decodePercent(const std::string& uri) {
  std::string decoded;
  decoded.reserve(uri.size());
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char value = 0;
    const char* digits = uri.data() + i + 1;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      decoded.push_back(static_cast<char>(value));
      i += 2;
    } else {
      decoded.push_back(uri[i]);
    }
  }
  return decoded;
}

Result<std::filesystem::path> resolveUri(const std::filesystem::path& folder, const std::string& uri,
                                         const std::string& subject, const std::string& object) {
  const std::string shown = uri.substr(0, 80);
  const std::size_t colon = uri.find(':');
  if (colon != std::string::npos && uri.find_first_of("/?#") > colon)
    return fail(subject,
                fmt::format("{} has the URI \"{}\", which is not a file beside the scene", object, shown),
                "save the data into the scene's folder");
  const std::string name = decodePercent(uri);
  if (name.empty() || name.find('\0') != std::string::npos)
    return fail(subject, fmt::format("{} has an empty or broken URI", object), "export the scene again");

  std::error_code error;
  const auto home = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), error);
  const auto file = error ? home : std::filesystem::weakly_canonical(home / name, error);
  const auto relative = error ? std::filesystem::path("..") : file.lexically_relative(home);
  if (relative.empty() || *relative.begin() == ".." || relative == ".")
    return fail(subject, fmt::format("{} (\"{}\") lies outside the scene's folder", object, shown),
                "move it beside the scene");
  return file;
}

}  // namespace lambent::baker
