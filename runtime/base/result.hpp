// The room base owns errors as values, files that appear whole or not at all, and work on several threads.
// Bad input (a file, an option, a device) is returned as an Error, which a program prints as one line. Bugs
// are caught by assertions instead. All functions of the room may be called from any thread; an object is
// used by one thread at a time unless its header says otherwise.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

namespace lambent {

struct Error {
  std::string subject;  // the file, option or device that the error is about
  std::string problem;  // what is wrong with the subject
  std::string hint;     // what the user can do about it; may be empty

  // Returns "SUBJECT: PROBLEM; HINT", which every program prints after its own name.
  std::string line() const;
};

template <typename T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string subject, std::string problem, std::string hint = {}) {
  return tl::unexpected<Error>(Error{std::move(subject), std::move(problem), std::move(hint)});
}

// Passes an error on as the result of another type.
inline tl::unexpected<Error> failAgain(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace lambent
