#include "runtime/streaming/work.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "runtime/streaming/image_decode.hpp"

namespace lambent::streaming {
namespace {

template <class... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};

struct Ranked {
  std::uint32_t priority;
  Work work;
};

void appendByPriority(std::vector<Work>& list, std::vector<Ranked> ranked) {
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Ranked& a, const Ranked& b) { return a.priority < b.priority; });
  for (const Ranked& item : ranked) list.push_back(item.work);
}

template <class Place>  // BasisWork or PlaneWork
const bundle::Cell& cellOf(const bundle::Description& description, const Place& at) {
  return description.groups[at.group].cells[at.cell];
}
template <class Place>
const bundle::DiffuseTransfer& transferOf(const bundle::Description& description, const Place& at) {
  return cellOf(description, at).diffuse[at.transfer];
}

template <class T>
std::size_t sizeInBytes(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

using Loaded = std::optional<Result<Ready>>;

class Load {
 public:
  Load(const bundle::Reader& reader, const Reserve& reserve)
      : reader_(reader), description_(reader.description()), reserve_(reserve) {}

  Loaded operator()(const MeshWork& work) const {
    const bundle::Primitive& primitive = description_.meshes[work.mesh].primitives[work.primitive];
    // As if every attribute were there: it costs nothing to leave some room.
    constexpr std::size_t kVertexBytes = sizeof(float) * (3 + 3 + 2 + 2 + 4);
    if (!reserve_(primitive.vertex_count * kVertexBytes + primitive.index_count * sizeof(std::uint32_t)))
      return {};
    auto mesh = reader_.readMesh(work.mesh, work.primitive);
    if (!mesh) return failAgain(mesh.error());
    return MeshReady{work.mesh, work.primitive, std::move(*mesh)};
  }

  Loaded operator()(const RowsWork& work) const {
    const bundle::Draw& draw = description_.draws[work.draw];
    // Six bytes of an entry in the file become eight.
    if (!reserve_(description_.payloads[draw.rows].raw_length * 2)) return {};
    const auto bytes = reader_.readPayload(draw.rows);
    if (!bytes) return failAgain(bytes.error());
    auto rows = bundle::decodeRows(
        *bytes, description_.meshes[draw.mesh].primitives[draw.primitive].vertex_count,
        description_.groups[draw.group].sample_count, named(fmt::format("draw {}", work.draw)));
    if (!rows) return failAgain(rows.error());
    return RowsReady{work.draw, std::move(*rows)};
  }

  Loaded operator()(const ImageWork& work) const {
    const bundle::Image& image = description_.images[work.image];
    const std::string subject = named(fmt::format("image {} \"{}\"", work.image, image.name));
    const auto file = reader_.readView(image.view);
    if (!file) return failAgain(file.error());
    const auto size = imageSize(*file, subject);
    if (!size) return failAgain(size.error());
    if (!reserve_(size->rgbaBytes())) return {};
    auto rgba = decodeRgba(*file, subject);
    if (!rgba) return failAgain(rgba.error());
    return ImageReady{work.image, size->width, size->height, std::move(*rgba)};
  }

  Loaded operator()(const BasisWork& work) const {
    const bundle::DiffuseTransfer& transfer = transferOf(description_, work);
    const std::size_t values = (1 + transfer.planes.size()) * transfer.channels * transfer.columns();
    if (!reserve_(values * sizeof(float))) return {};
    const auto bytes = reader_.readPayload(transfer.basis);
    if (!bytes) return failAgain(bytes.error());
    auto vectors = bundle::decodeBasis(*bytes, values,
                                       named(fmt::format("group {} cell {} basis", work.group, work.cell)));
    if (!vectors) return failAgain(vectors.error());
    return BasisReady{work.group, work.cell, work.transfer, std::move(*vectors)};
  }

  Loaded operator()(const PlaneWork& work) const {
    const bundle::WeightPlane& plane = transferOf(description_, work).planes[work.plane];
    if (!reserve_(description_.payloads[plane.payload].raw_length)) return {};
    auto codes = reader_.readPayload(plane.payload);
    if (!codes) return failAgain(codes.error());
    const std::size_t expected = std::size_t{cellOf(description_, work).sample_count} * plane.bits / 8;
    if (codes->size() != expected)
      return fail(named(fmt::format("group {} cell {} plane {}", work.group, work.cell, work.plane)),
                  fmt::format("has {} bytes of codes, not {}", codes->size(), expected), "bake it again");
    return PlaneReady{work.group, work.cell, work.transfer, work.plane, std::move(*codes)};
  }

 private:
  // "PATH: WHAT", the subject of an error.
  std::string named(const std::string& what) const { return reader_.path().string() + ": " + what; }
  static Result<Ready> failAgain(Error error) { return lambent::failAgain(std::move(error)); }
  static Result<Ready> fail(std::string subject, std::string problem, std::string mend) {
    return lambent::fail(std::move(subject), std::move(problem), std::move(mend));
  }

  const bundle::Reader& reader_;
  const bundle::Description& description_;
  const Reserve& reserve_;
};

}  // namespace

std::vector<Work> workList(const bundle::Description& d) {
  std::vector<Work> list;
  for (std::uint32_t mesh = 0; mesh < d.meshes.size(); ++mesh) {
    for (std::uint32_t p = 0; p < d.meshes[mesh].primitives.size(); ++p) list.push_back(MeshWork{mesh, p});
  }
  std::vector<Ranked> rows, transfer;
  for (std::uint32_t draw = 0; draw < d.draws.size(); ++draw) {
    rows.push_back({d.payloads[d.draws[draw].rows].priority, RowsWork{draw}});
  }
  appendByPriority(list, std::move(rows));
  for (std::uint32_t image = 0; image < d.images.size(); ++image) list.push_back(ImageWork{image});
  for (std::uint32_t group = 0; group < d.groups.size(); ++group) {
    for (std::uint32_t cell = 0; cell < d.groups[group].cells.size(); ++cell) {
      const auto& parts = d.groups[group].cells[cell].diffuse;
      for (std::uint32_t t = 0; t < parts.size(); ++t) {
        std::uint32_t priority = d.payloads[parts[t].basis].priority;
        transfer.push_back({priority, BasisWork{group, cell, t}});
        for (std::uint32_t plane = 0; plane < parts[t].planes.size(); ++plane) {
          priority = std::max(priority, d.payloads[parts[t].planes[plane].payload].priority);
          transfer.push_back({priority, PlaneWork{group, cell, t, plane}});
        }
      }
    }
  }
  appendByPriority(list, std::move(transfer));
  return list;
}

std::uint32_t viewOf(const bundle::Description& d, const Work& work) {
  return std::visit(
      Overloaded{
          [&](const MeshWork& at) { return d.meshes[at.mesh].primitives[at.primitive].view; },
          [&](const RowsWork& at) { return d.payloads[d.draws[at.draw].rows].view; },
          [&](const ImageWork& at) { return d.images[at.image].view; },
          [&](const BasisWork& at) { return d.payloads[transferOf(d, at).basis].view; },
          [&](const PlaneWork& at) { return d.payloads[transferOf(d, at).planes[at.plane].payload].view; }},
      work);
}

std::optional<Result<Ready>> load(const bundle::Reader& reader, const Work& work, const Reserve& reserve) {
  return std::visit(Load(reader, reserve), work);
}

std::size_t bytesOf(const Ready& ready) {
  return std::visit(Overloaded{[](const MeshReady& item) {
                                 return sizeInBytes(item.data.positions) + sizeInBytes(item.data.normals) +
                                        sizeInBytes(item.data.texcoords0) +
                                        sizeInBytes(item.data.texcoords1) + sizeInBytes(item.data.colors) +
                                        sizeInBytes(item.data.indices);
                               },
                               [](const ImageReady& item) { return sizeInBytes(item.rgba); },
                               [](const RowsReady& item) {
                                 return sizeInBytes(item.rows.offsets) + sizeInBytes(item.rows.samples) +
                                        sizeInBytes(item.rows.weights);
                               },
                               [](const BasisReady& item) { return sizeInBytes(item.vectors); },
                               [](const PlaneReady& item) { return sizeInBytes(item.codes); }},
                    ready);
}

}  // namespace lambent::streaming
