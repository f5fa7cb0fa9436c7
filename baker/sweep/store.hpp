// Keeps rows in a file, one JSON object a line, each appended as soon as it is measured. A sweep that was cut
// short finds them there and measures only what is missing. A row is found by a key of everything that it
// depends on, so those of another scene, program or option may lie in the same file. A last line that was
// cut short, and lines of another form, are left out.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "runtime/base/result.hpp"

namespace lambent::baker {

class Store {
 public:
  // Reads the file, if it is there.
  static Result<Store> open(const std::filesystem::path& file);

  // Returns nothing if there is no such row, or it has another form.
  template <typename Row>
  std::optional<Row> find(const std::string& key) const {
    const auto found = rows_.find(key);
    if (found == rows_.end()) return std::nullopt;
    try {
      return found->second.get<Row>();
    } catch (const nlohmann::json::exception&) {
      return std::nullopt;
    }
  }
  // Adds a row, in place of an earlier one of that key. `what` says in words what it measures, for readers.
  template <typename Row>
  Result<void> add(const std::string& key, const std::string& what, const Row& row) {
    return append(key, what, nlohmann::json(row));
  }
  std::size_t added() const { return added_; }

 private:
  explicit Store(std::filesystem::path file) : file_(std::move(file)) {}
  Result<void> append(const std::string& key, const std::string& what, nlohmann::json row);

  std::filesystem::path file_;
  std::map<std::string, nlohmann::json> rows_;
  std::size_t added_ = 0;
  bool cut_short_ = false;  // the file's last line has no end
};

}  // namespace lambent::baker
