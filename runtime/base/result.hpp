// Errors as values. Bad input (a file, an option, a device) is told apart from a bug: it comes back as an
// Error that names the thing and the hint, and a program prints it as one line. Broken invariants are
// assertions.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

namespace lambent {

struct Error {
  std::string subject;  // what it is about: a file, an option, a device
  std::string problem;  // what is wrong with it
  std::string hint;     // what to do about it; may be empty

  // "SUBJECT: PROBLEM; MEND", the line that every program prints after its own name.
  std::string line() const;
};

template <typename T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(std::string subject, std::string problem, std::string hint = {}) {
  return tl::unexpected<Error>(Error{std::move(subject), std::move(problem), std::move(hint)});
}

// Hands an error on under the name of the file that it came up in.
inline tl::unexpected<Error> failAgain(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace lambent
