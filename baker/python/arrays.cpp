#include "baker/python/arrays.hpp"

#include <algorithm>

namespace lambent::python {

void raise(const Failure& failure) {
  throw py::value_error(failure.line());
}

std::vector<Vec3> vectorsOf(const Floats& array, const std::string& name) {
  if (array.ndim() < 1 || array.shape(array.ndim() - 1) != 3)
    raise({name, "is not an array of vectors", "its last side is 3"});
  const auto count = static_cast<std::size_t>(array.size() / 3);
  std::vector<Vec3> vectors(count);
  for (std::size_t i = 0; i < count; ++i)
    vectors[i] = {array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]};
  return vectors;
}

Floats arrayOf(const std::vector<Vec3>& vectors) {
  Floats array({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}});
  float* out = array.mutable_data();
  for (const Vec3& v : vectors) out = std::copy_n(&v.x, 3, out);
  return array;
}

Floats arrayOf(const std::vector<float>& values, const std::vector<py::ssize_t>& shape) {
  Floats array(shape);
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

Words arrayOf(const std::vector<std::uint32_t>& values, const std::vector<py::ssize_t>& shape) {
  Words array(shape);
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

LightVector lightOf(const Floats& coefficients) {
  LightVector light;
  light.coefficients = vectorsOf(coefficients, "light");
  light.order = 1;
  while (light.order < kMaxBands &&
         static_cast<std::size_t>(light.order * light.order) < light.coefficients.size())
    ++light.order;
  if (static_cast<std::size_t>(light.order * light.order) != light.coefficients.size())
    raise({"light", "has " + std::to_string(light.coefficients.size()) + " coefficients",
           "order n has n², n 1..8"});
  return light;
}

}  // namespace lambent::python
