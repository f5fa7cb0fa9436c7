// Failures as values: the library throws nothing of its own, and prints nothing. What the standard library
// throws when memory runs out passes through.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace lambent {

// Says what a file, a word or a device lacks, as lambent's programs print it.
struct Failure {
  std::string subject{};  // the file, the word or the device
  std::string problem{};  // what is wrong with it
  std::string hint{};     // what to do about it; may be empty

  // Returns "SUBJECT: PROBLEM; HINT".
  std::string line() const { return subject + ": " + problem + (hint.empty() ? std::string() : "; " + hint); }
};

// Holds a value or a failure. Ask before the value is taken: without one, *expected throws
// std::bad_variant_access.
template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : held_(std::in_place_index<0>, std::move(value)) {}
  Expected(Failure failure) : held_(std::in_place_index<1>, std::move(failure)) {}

  explicit operator bool() const { return held_.index() == 0; }
  T& operator*() { return std::get<0>(held_); }
  const T& operator*() const { return std::get<0>(held_); }
  T* operator->() { return &std::get<0>(held_); }
  const T* operator->() const { return &std::get<0>(held_); }
  const Failure& failure() const { return std::get<1>(held_); }

 private:
  std::variant<T, Failure> held_;
};

template <>
class [[nodiscard]] Expected<void> {
 public:
  Expected() = default;
  Expected(Failure failure) : held_(std::move(failure)) {}

  explicit operator bool() const { return held_.index() == 0; }
  const Failure& failure() const { return std::get<1>(held_); }

 private:
  std::variant<std::monostate, Failure> held_;
};

}  // namespace lambent
