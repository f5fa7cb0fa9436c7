// The table of a bake's options: a row for each has its name, its help and the form of its words. The command
// line, the editor's panel and its command, the checks before a bake, the settings that a bundle records and
// the journal of unfinished bakes all walk this table. A new option is a member of BakeOptions and a row in
// option_rows.cpp. Errors name the option: a word is not of its kind, or a value lies outside its range.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/bake/options.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

struct OptionRow {
  std::string_view name;     // as in --name, in scripts and journals
  std::string_view group;    // its heading in the help
  std::string_view setting;  // in the settings that a bundle records; empty: it does not change the bytes
  std::string_view kind;     // what a word looks like, for help: "N|auto"
  std::string help;
  std::vector<std::string_view> words{};  // words that stand for values
  bool only_words = false;                // it takes no other words
  bool shows_default = false;             // the default is a value like others, not "auto" or "none"

  std::string (*word)(const BakeOptions&) = nullptr;
  // Returns what the bundle records, which most often is the word.
  std::string (*record)(const BakeOptions&) = nullptr;
  // Takes a word over, if it is of the option's kind and within its range.
  Result<void> (*put)(BakeOptions&, std::string_view word) = nullptr;
  // Takes over what word() or record() wrote. Returns false if it is not of the option's kind.
  bool (*read)(BakeOptions&, std::string_view word) = nullptr;
  // Checks the value itself, which may not come from a word.
  Result<void> (*check)(const BakeOptions&) = nullptr;
  std::string_view former{};  // the name before 0.11, which is still understood but not shown; may be empty
};

// Returns the rows in the order of the help.
std::span<const OptionRow> optionRows();
const OptionRow* findOption(std::string_view name);  // null if there is none

// Sets an option by its name and a word, as scripts do.
Result<void> putOption(BakeOptions& options, std::string_view name, std::string_view word);
// Checks that every option lies in its range.
Result<void> checkOptions(const BakeOptions& options);

}  // namespace lambent::baker
