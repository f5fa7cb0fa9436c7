// The Python module `lambent`: light in harmonics, bundles as arrays, and baking (docs/python.md).
#include <array>

#include <pybind11/stl.h>

#include "baker/python/arrays.hpp"
#include "lambent/bundle.hpp"
#include "lambent/version.hpp"

namespace lambent::python {
namespace {

Floats harmonics(int order, const Floats& directions) {
  const std::vector<Vec3> vectors = vectorsOf(directions, "directions");
  const py::ssize_t count = py::ssize_t{order} * order;
  Floats out({static_cast<py::ssize_t>(vectors.size()), count});
  for (std::size_t i = 0; i < vectors.size(); ++i)
    check(evaluateHarmonics(
        order, vectors[i],
        {out.mutable_data() + static_cast<py::ssize_t>(i) * count, static_cast<std::size_t>(count)}));
  return out;
}

Floats project(const Floats& picture, int order) {
  if (picture.ndim() != 3) raise({"picture", "is no picture", "its shape is height x width x 3"});
  return arrayOf(valueOf(projectEquirect(vectorsOf(picture, "picture"), static_cast<int>(picture.shape(1)),
                                         static_cast<int>(picture.shape(0)), order))
                     .coefficients);
}

Floats rotate(const Floats& light, const Floats& local_from_world) {
  if (local_from_world.size() != 9) raise({"local_from_world", "is no 3 x 3 matrix", {}});
  std::array<float, 9> rows;
  std::copy_n(local_from_world.data(), 9, rows.begin());
  return arrayOf(valueOf(lightOf(light).rotated(rows)).coefficients);
}

template <class Function>
Floats each(const Floats& light, const Floats& directions, const Function& function) {
  const LightVector vector = lightOf(light);
  std::vector<Vec3> values = vectorsOf(directions, "directions");
  for (Vec3& value : values) value = function(vector, value);
  return arrayOf(values);
}

py::dict surfaceOf(const Bundle& bundle, std::uint32_t index) {
  const SurfaceData data = valueOf(bundle.surface(index));
  const auto count = [](const auto& values) { return static_cast<py::ssize_t>(values.size()); };
  py::dict out;
  out["positions"] = arrayOf(data.positions);
  out["normals"] = arrayOf(data.normals);
  out["triangles"] = arrayOf(data.indices, {count(data.indices) / 3, 3});
  out["row_offsets"] = arrayOf(data.offsets, {count(data.offsets)});
  out["row_samples"] = arrayOf(data.samples, {count(data.samples)});
  out["row_weights"] = arrayOf(data.weights, {count(data.weights)});
  return out;
}

Floats transferOf(const Bundle& bundle, std::uint32_t group, std::uint32_t block) {
  const std::vector<float> values = valueOf(bundle.transfer(group, block));
  const TransferBlock& shape = bundle.groups()[group].blocks[block];
  return arrayOf(values, {shape.samples, shape.channels(), shape.outputs, shape.columns});
}

Floats matrixOf(const Matrix4& matrix) {
  Floats out({4, 4});
  for (py::ssize_t i = 0; i < 16; ++i) out.mutable_at(i % 4, i / 4) = matrix[static_cast<std::size_t>(i)];
  return out;
}

py::tuple tupleOf(const Vec3& v) {
  return py::make_tuple(v.x, v.y, v.z);
}

}  // namespace
}  // namespace lambent::python

PYBIND11_MODULE(lambent, module) {
  using namespace lambent;
  using namespace lambent::python;
  module.doc() = "Precomputed radiance transfer: light in harmonics, bundles as arrays, and baking.";
  module.attr("__version__") = version();
  module.def("harmonics", &harmonics, "Values of the real spherical harmonics: directions x order².",
             py::arg("order"), py::arg("directions"));
  module.def("project", &project,
             "Light vector, order² x 3, of a lat-long picture of radiance, height x width x 3.",
             py::arg("picture"), py::arg("order") = 5);
  module.def(
      "light",
      [](const std::vector<std::string>& words, int order) {
        return arrayOf(valueOf(lightFrom(words, order)).coefficients);
      },
      "Light vector of words as --light takes them: environment maps, suns, constants.", py::arg("words"),
      py::arg("order") = 5);
  module.def("rotate", &rotate, "Light as a frame that is turned sees it.", py::arg("light"),
             py::arg("local_from_world"));
  module.def(
      "radiance",
      [](const Floats& light, const Floats& directions) {
        return each(light, directions, [](const LightVector& l, const Vec3& d) { return l.radiance(d); });
      },
      "Radiance that arrives from unit directions.", py::arg("light"), py::arg("directions"));
  module.def(
      "irradiance_over_pi",
      [](const Floats& light, const Floats& normals) {
        return each(light, normals,
                    [](const LightVector& l, const Vec3& n) { return l.irradianceOverPi(n); });
      },
      "Irradiance / pi on unoccluded surfaces with unit normals.", py::arg("light"), py::arg("normals"));
  module.def(
      "without_ringing",
      [](const Floats& light) { return arrayOf(lightOf(light).withoutRinging().coefficients); },
      "The light, changed least so that no direction is negative.", py::arg("light"));

  py::class_<TransferBlock>(module, "Block", "Transfer of a run of samples of a group.")
      .def_property_readonly("form", [](const TransferBlock& b) { return nameOf(b.form); })
      .def_property_readonly("place", [](const TransferBlock& b) { return nameOf(b.place); })
      .def_readonly("first_sample", &TransferBlock::first_sample)
      .def_readonly("samples", &TransferBlock::samples)
      .def_readonly("order", &TransferBlock::order)
      .def_readonly("lamps", &TransferBlock::lamps)
      .def_readonly("shadowed_channels", &TransferBlock::shadowed_channels)
      .def_readonly("full_channels", &TransferBlock::full_channels)
      .def_readonly("outputs", &TransferBlock::outputs)
      .def_readonly("columns", &TransferBlock::columns);
  py::class_<GroupInfo>(module, "Group", "What never moves within itself.")
      .def_readonly("name", &GroupInfo::name)
      .def_readonly("samples", &GroupInfo::samples)
      .def_readonly("lamps", &GroupInfo::lamps)
      .def_readonly("blocks", &GroupInfo::blocks)
      .def_property_readonly("world_from_group",
                             [](const GroupInfo& g) { return matrixOf(g.world_from_group); })
      .def_property_readonly("bounds_min", [](const GroupInfo& g) { return tupleOf(g.bounds_min); })
      .def_property_readonly("bounds_max", [](const GroupInfo& g) { return tupleOf(g.bounds_max); });
  py::class_<SurfaceInfo>(module, "Surface", "One side of a primitive at a node.")
      .def_readonly("mesh", &SurfaceInfo::mesh)
      .def_readonly("material", &SurfaceInfo::material)
      .def_readonly("group", &SurfaceInfo::group)
      .def_readonly("vertices", &SurfaceInfo::vertices)
      .def_readonly("triangles", &SurfaceInfo::triangles)
      .def_readonly("back", &SurfaceInfo::back)
      .def_property_readonly("form", [](const SurfaceInfo& s) { return nameOf(s.form); })
      .def_property_readonly("albedo", [](const SurfaceInfo& s) { return tupleOf(s.albedo); });
  py::class_<Bundle>(module, "Bundle", "A bundle that lambent baked; read-only.")
      .def(py::init([](const std::string& path) { return valueOf(Bundle::open(path)); }), py::arg("path"))
      .def_property_readonly("groups", &Bundle::groups)
      .def_property_readonly("surfaces", &Bundle::surfaces)
      .def("surface", &surfaceOf,
           "Arrays of a surface: positions, normals, triangles, and the rows that take vertices to samples.",
           py::arg("index"))
      .def("transfer", &transferOf, "samples x channels x outputs x columns of a block.", py::arg("group"),
           py::arg("block"))
      .def(
          "shade",
          [](const Bundle& bundle, std::uint32_t index, const Floats& light, bool full) {
            return arrayOf(valueOf(bundle.shade(index, lightOf(light), full)));
          },
          "Irradiance / pi at the vertices of a diffuse surface under light in its group's frame.",
          py::arg("surface"), py::arg("light"), py::arg("full") = true);
  addBaking(module);
}
