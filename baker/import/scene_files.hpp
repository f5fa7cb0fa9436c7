// Finds and opens the files of a scene. This room throws Errors, and returns them where others call it.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "baker/import/gltf.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// For files that break the rules of glTF.
inline constexpr const char* kExportAgain = "export the scene again, or look at it with a glTF validator";

// Throws an Error about the file that is being read. resultOf() adds the file's name and a hint.
template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> problem, Args&&... args) {
  throw Error{{}, fmt::format(problem, std::forward<Args>(args)...), {}};
}

template <typename T>
T orThrow(Result<T> result) {
  if (!result) throw std::move(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// Returns the exception's text without the tag that nlohmann::json puts in front.
inline std::string reasonOf(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception)) return "it needs more memory than there is";
  const std::string text = exception.what();
  const std::size_t tag = text.starts_with("[json.") ? text.find("] ") : std::string::npos;
  return tag == std::string::npos ? text : text.substr(tag + 2);
}

// Returns what read() returns, or as an Error what it throws, which libraries do, too. `done` is a participle
// such as "imported"; `hint` is for errors without one.
template <typename Read>
auto resultOf(const std::string& subject, const char* done, const char* hint, Read read)
    -> Result<std::invoke_result_t<Read>> {
  try {
    return read();
  } catch (Error& error) {
    if (error.subject.empty()) error.subject = subject;
    if (error.hint.empty()) error.hint = hint;
    return failAgain(std::move(error));
  } catch (const std::exception& exception) {
    return fail(subject, fmt::format("cannot be {} ({})", done, reasonOf(exception)), hint);
  }
}

// Opens a glTF file. It tells .gltf text from a .glb container by the first bytes and takes the container
// apart. The JSON text and, for a .glb, its binary chunk go out; every length is compared with the file's
// before use. Source: glTF 2.0 specification, section 4 (GLB).

struct Container {
  std::string json;
  std::vector<std::byte> binary;  // empty if there is no binary chunk
};

// Errors: missing or empty file, damaged container, glTF 1.
Result<Container> openContainer(const std::filesystem::path& path);

// Returns the bytes of a file. Errors name `subject`: the file is missing, a folder or unreadable.
std::vector<std::byte> readBytes(const std::filesystem::path& path, const std::string& subject);

// Resolves relative URIs of a glTF file to files beside it. A scene may come from anywhere, so it may only
// name files in its own folder or below: absolute paths, ".." past the folder and links that lead out are
// refused unless ImportOptions::allow_outside is set. Other schemes (http:, file:) are always refused. Names
// that only differ in ways that other systems do not mind, such as backslashes or the case of letters, are
// found with a warning.

// Undoes percent-encoding: "Box%20With%20Spaces.bin" becomes "Box With Spaces.bin".
std::string decodePercent(const std::string& uri);

// Returns the file that `uri` of the scene `file` names. Errors name the scene and `object` ("buffer 0").
std::filesystem::path resolveUri(const std::filesystem::path& file, const std::string& uri,
                                 const ImportOptions& options, const std::string& object,
                                 std::vector<std::string>& warnings);

// Returns the bytes behind a URI of the scene `file`: a data: URI (base64 or percent-encoded, of any media
// type) or a file. Errors name the scene and `object`.
std::vector<std::byte> readUri(const std::filesystem::path& file, const std::string& uri,
                               const ImportOptions& options, const std::string& object,
                               std::vector<std::string>& warnings);

}  // namespace lambent::baker
