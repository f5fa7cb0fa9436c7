// The Python module `lambent`: light in harmonics, bundles as arrays, and baking (docs/python.md).
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "lambent/bake.hpp"
#include "lambent/bundle.hpp"
#include "lambent/version.hpp"

namespace lambent::python {
namespace {

namespace py = pybind11;
// Whatever is given is made a dense array of this type.
template <class Value>
using Array = py::array_t<Value, py::array::c_style | py::array::forcecast>;
using Floats = Array<float>;
using Words = Array<std::uint32_t>;

// A failure of the library is a ValueError with its line.
[[noreturn]] void raise(const Failure& failure) {
  throw py::value_error(failure.line());
}
template <class T>
T valueOf(Expected<T> expected) {
  if (!expected) raise(expected.failure());
  return std::move(*expected);
}
void check(const Expected<void>& expected) {
  if (!expected) raise(expected.failure());
}

// Takes an array whose last side is three. Raises, naming it, if it is not.
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

template <class Value>
Array<Value> arrayOf(const std::vector<Value>& values, const std::vector<py::ssize_t>& shape) {
  Array<Value> array(shape);
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

// Light as an array of order² x 3.
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

Vec3 colorOf(const py::handle& value, const std::string& name) {
  const std::vector<Vec3> one = vectorsOf(py::cast<Floats>(value), name);
  if (one.size() != 1) raise({name, "is no colour", "give three numbers"});
  return one[0];
}

void addMesh(BakeScene& scene, const py::dict& described) {
  std::vector<Vec3> positions, normals;  // until the mesh has been added
  std::vector<std::uint32_t> indices;
  BakeMesh mesh;
  for (const auto& [key, value] : described) {
    const auto name = py::cast<std::string>(key);
    if (name == "name")
      mesh.name = py::cast<std::string>(value);
    else if (name == "positions")
      positions = vectorsOf(py::cast<Floats>(value), name);
    else if (name == "normals")
      normals = vectorsOf(py::cast<Floats>(value), name);
    else if (name == "triangles") {
      const auto words = py::cast<Words>(value);
      indices.assign(words.data(), words.data() + words.size());
    } else if (name == "albedo")
      mesh.albedo = colorOf(value, name);
    else if (name == "emission")
      mesh.emission = colorOf(value, name);
    else if (name == "metallic")
      mesh.metallic = py::cast<float>(value);
    else if (name == "roughness")
      mesh.roughness = py::cast<float>(value);
    else if (name == "double_sided")
      mesh.double_sided = py::cast<bool>(value);
    else if (name == "movable")
      mesh.movable = py::cast<bool>(value);
    else if (name == "world_from_mesh") {
      const auto matrix = py::cast<Floats>(value);
      if (matrix.size() != 16) raise({name, "is no 4 x 4 matrix", {}});
      for (std::size_t i = 0; i < 16; ++i) mesh.world_from_mesh[i] = matrix.data()[i % 4 * 4 + i / 4];
    } else
      raise({name, "is nothing that a mesh has", "see docs/python.md"});
  }
  mesh.positions = positions;
  mesh.normals = normals;
  mesh.indices = indices;
  check(scene.add(mesh));
}

py::dict bake(const py::object& source, const std::string& output, const py::object& progress,
              const std::string& cache, const py::kwargs& options) {
  BakeScene scene;
  if (py::isinstance<py::str>(source) || py::hasattr(source, "__fspath__"))
    scene = valueOf(BakeScene::open(py::cast<std::string>(py::str(source))));
  else
    for (const py::handle mesh : source) addMesh(scene, py::cast<py::dict>(mesh));
  Baker baker;
  for (const auto& [key, value] : options) {
    std::string name = py::cast<std::string>(key);
    std::ranges::replace(name, '_', '-');
    check(baker.set(name, py::cast<std::string>(py::str(value))));
  }
  if (!cache.empty()) check(baker.keepResultsIn(cache));
  // The bake runs on a thread of its own. This one, which Python called, shows progress and looks for Ctrl-C.
  std::mutex lock;
  std::optional<BakeProgress> latest;
  std::atomic<bool> stop = false;
  const auto watch = [&](const BakeProgress& seen) {
    const std::lock_guard held(lock);
    latest = seen;
    return !stop;
  };
  auto running = std::async(std::launch::async, [&] { return baker.run(scene, output, watch); });
  std::exception_ptr raised;
  const auto over = [&] {
    const py::gil_scoped_release released;
    return running.wait_for(std::chrono::milliseconds(100)) == std::future_status::ready;
  };
  while (!over()) {
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      std::optional<BakeProgress> seen;
      {
        const std::lock_guard held(lock);
        seen = std::exchange(latest, {});
      }
      if (!seen || progress.is_none()) continue;
      const py::object answer = progress(seen->fraction, seen->stage);
      if (!answer.is_none() && !py::cast<bool>(answer)) stop = true;
    } catch (...) {
      raised = std::current_exception();
      stop = true;
    }
  }
  Expected<BakeResult> result = running.get();
  if (raised) std::rethrow_exception(raised);
  const BakeResult done = valueOf(std::move(result));
  py::dict out;
  out["rays"] = done.rays;
  out["samples"] = done.samples;
  out["file_bytes"] = done.file_bytes;
  out["seconds"] = done.seconds;
  out["notices"] = done.notices;
  return out;
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
  module.def("bake", &bake,
             "Bakes a glTF file, or a list of meshes as dictionaries of arrays, into a bundle. Keywords are "
             "the options of "
             "`lambent bake`; progress(fraction, stage) may return False to stop.",
             py::arg("scene"), py::arg("output"), py::arg("progress") = py::none(), py::arg("cache") = "");
}
