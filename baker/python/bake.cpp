// bake() of the Python module.
#include "lambent/bake.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "baker/python/arrays.hpp"

namespace lambent::python {
namespace {

// Holds the arrays of a mesh while it is added.
struct MeshArrays {
  std::vector<Vec3> positions, normals;
  std::vector<std::uint32_t> indices;
};

Vec3 colorOf(const py::handle& value, const std::string& name) {
  const std::vector<Vec3> one = vectorsOf(py::cast<Floats>(value), name);
  if (one.size() != 1) raise({name, "is no colour", "give three numbers"});
  return one[0];
}

void addMesh(BakeScene& scene, const py::dict& described) {
  MeshArrays arrays;
  BakeMesh mesh;
  for (const auto& [key, value] : described) {
    const auto name = py::cast<std::string>(key);
    if (name == "name")
      mesh.name = py::cast<std::string>(value);
    else if (name == "positions")
      arrays.positions = vectorsOf(py::cast<Floats>(value), name);
    else if (name == "normals")
      arrays.normals = vectorsOf(py::cast<Floats>(value), name);
    else if (name == "triangles") {
      const auto words = py::cast<Words>(value);
      arrays.indices.assign(words.data(), words.data() + words.size());
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
  mesh.positions = arrays.positions;
  mesh.normals = arrays.normals;
  mesh.indices = arrays.indices;
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

void addBaking(py::module_& module) {
  module.def("bake", &bake,
             "Bakes a glTF file, or a list of meshes as dictionaries of arrays, into a bundle. Keywords are "
             "the options of "
             "`lambent bake`; progress(fraction, stage) may return False to stop.",
             py::arg("scene"), py::arg("output"), py::arg("progress") = py::none(), py::arg("cache") = "");
}

}  // namespace lambent::python
