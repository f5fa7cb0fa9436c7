// Gives the buffers of a checked document by number. They come from files beside it, data: URIs, the binary
// chunk, or views coded by meshoptimizer. Each is found, bounds-checked and read here, once; tinygltf opens
// no file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "baker/import/scene_files.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

class BufferSource {
 public:
  // Replaces the URI of each buffer by its number, because tinygltf asks for buffers by URI.
  BufferSource(nlohmann::json& document, std::vector<std::byte> binary, const std::filesystem::path& path,
               const ImportOptions& options, std::vector<std::string>& warnings);

  // Returns as many bytes as the buffer announces. Errors name the file and "buffer 2".
  Result<std::vector<std::byte>> read(std::size_t buffer);

 private:
  struct CodedView {
    std::size_t index = 0, offset = 0, length = 0;
    nlohmann::json extension;
  };
  struct Wanted {
    std::string uri;
    std::size_t length = 0;
    std::vector<CodedView> coded;  // if not empty, the buffer is made of these
  };

  Result<std::vector<std::byte>> load(std::size_t buffer);
  Result<std::vector<std::byte>> decode(const Wanted& buffer);

  std::vector<Wanted> wanted_;
  std::set<std::size_t> sources_;                       // buffers that coded views read from
  std::map<std::size_t, std::vector<std::byte>> kept_;  // those of them that were loaded
  std::vector<std::byte> binary_;
  std::filesystem::path path_;
  ImportOptions options_;
  std::vector<std::string>& warnings_;
};

}  // namespace lambent::baker
