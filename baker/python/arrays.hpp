// Converts between NumPy arrays and the values of the library.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "lambent/math.hpp"
#include "lambent/result.hpp"
#include "lambent/sh.hpp"

namespace lambent::python {

namespace py = pybind11;
// Whatever is given is made a dense array of this type.
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Words = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

// A failure of the library is a ValueError with its line.
[[noreturn]] void raise(const Failure& failure);
template <class T>
T valueOf(Expected<T> expected) {
  if (!expected) raise(expected.failure());
  return std::move(*expected);
}
inline void check(const Expected<void>& expected) {
  if (!expected) raise(expected.failure());
}

// Takes an array whose last side is three. Raises, naming it, if it is not.
std::vector<Vec3> vectorsOf(const Floats& array, const std::string& name);
Floats arrayOf(const std::vector<Vec3>& vectors);  // n x 3
Floats arrayOf(const std::vector<float>& values, const std::vector<py::ssize_t>& shape);
Words arrayOf(const std::vector<std::uint32_t>& values, const std::vector<py::ssize_t>& shape);

// Light as an array of order² x 3.
LightVector lightOf(const Floats& coefficients);

// Adds what bakes to the module (bake.cpp).
void addBaking(py::module_& module);

}  // namespace lambent::python
