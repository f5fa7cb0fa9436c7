#include "baker/compress/kept_transfer.hpp"

#include "baker/jobs/stage.hpp"

namespace lambent::baker {

template <>
inline constexpr bool kPlainBytes<transfer::AxisCode> = sizeof(transfer::AxisCode) == 2 * sizeof(float);

void write(const transfer::SharedCodebook& book, ByteWriter& out) {
  out.addList(book.axis_counts), out.addList(book.axes);
  out.addList(book.value_scales), out.addList(book.basis_scales), out.add(book.mean_scale);
  out.addList(book.basis), out.addList(book.means), out.addList(book.directions);
}

bool read(ByteReader& in, transfer::SharedCodebook& book) {
  return in.readList(book.axis_counts) && in.readList(book.axes) && in.readList(book.value_scales) &&
         in.readList(book.basis_scales) && in.read(book.mean_scale) && in.readList(book.basis) &&
         in.readList(book.means) && in.readList(book.directions);
}

void write(const CodedTransfer& coded, ByteWriter& out) {
  out.add(coded.shape), out.add(coded.error);
  write(coded.codebook, out);
  out.addList(coded.cluster_of);
  out.add(std::uint64_t{coded.planes.size()});
  for (const CodedPlane& plane : coded.planes) {
    out.add(plane.bits), out.add(plane.variance);
    // Codes have at most 16 bits.
    out.addList(std::vector<std::uint16_t>(plane.codes.begin(), plane.codes.end()));
  }
}

bool read(ByteReader& in, CodedTransfer& coded) {
  std::uint64_t planes = 0;
  in.read(coded.shape), in.read(coded.error);
  read(in, coded.codebook);
  in.readList(coded.cluster_of);
  if (!in.read(planes)) return false;
  std::vector<std::uint16_t> codes;
  for (std::uint64_t p = 0; p < planes; ++p) {
    CodedPlane& plane = coded.planes.emplace_back();
    if (!in.read(plane.bits) || !in.read(plane.variance) || !in.readList(codes)) return false;
    plane.codes.assign(codes.begin(), codes.end());
  }
  return true;
}

void write(const CodedCell& cell, ByteWriter& out) {
  out.add(cell.count), out.add(cell.bounds_min), out.add(cell.bounds_max);
  write(cell.transfers, out);
}

bool read(ByteReader& in, CodedCell& cell) {
  return in.read(cell.count) && in.read(cell.bounds_min) && in.read(cell.bounds_max) &&
         read(in, cell.transfers);
}

CodedTransfer CachedCoding::code(std::span<const float> vectors, std::size_t count,
                                 const transfer::TransferShape& shape, const CodingSettings& settings) {
  Key key;
  if (context_.cache) {
    KeyMaker maker = KeyMaker::ofStage("coding");
    maker.add(shape).addList(vectors).add(settings.bound).add(settings.shown_energy);
    maker.add(settings.most_components).add(settings.loose_bound).add(settings.most_expanded_bytes);
    key = maker.add(settings.kernel_power).addList(settings.weights).key();
    kept_.push_back(key);
  }
  const BakeContext own = context_.keyed(key);
  CodedTransfer coded;
  findOrMake(own, coded, [&] {
    coded = codeTransfer(vectors, count, shape, settings, own.stop);
    return !own.stopped();
  });
  return coded;
}

void CachedCoding::drop() {
  for (const Key& key : kept_) dropValue(context_.keyed(key));
  kept_.clear();
}

}  // namespace lambent::baker
