#include "runtime/bundle/gltf_types.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/vec4.hpp>

namespace lambent::gltf {

namespace {

using Interpolation = AnimationChannel::Interpolation;

// Describes a time between the keys `first` and `first + 1`, which are `interval_s` apart. `share` is the
// fraction of the interval that has passed; if it is 0, only the first key counts.
struct Place {
  std::size_t first = 0;
  double share = 0.0, interval_s = 0.0;
};

Place placeOf(const AnimationChannel& channel, float time_s) {
  const std::vector<float>& times = channel.times_s;
  const float time = std::isfinite(time_s) ? time_s : 0.0f;
  const auto above = std::upper_bound(times.begin(), times.end(), time);
  if (above == times.begin()) return {};
  const auto first = static_cast<std::size_t>(above - times.begin()) - 1;
  if (above == times.end()) return {.first = first};
  // The interval is above 0, because `above` is later than the time and the key before it is not.
  const double interval = double{*above} - double{times[first]};
  return {.first = first, .share = (double{time} - double{times[first]}) / interval, .interval_s = interval};
}

template <int N>
using Vector = glm::vec<N, double>;

// Reads element `part` of a key. Cubic keys have in-tangent, value and out-tangent; other keys have only
// element 0.
template <int N>
Vector<N> read(const AnimationChannel& channel, std::size_t key, std::size_t part = 0) {
  const std::size_t parts = channel.interpolation == Interpolation::Cubic ? 3 : 1;
  const std::size_t at = (key * parts + part) * N;
  Vector<N> value(0.0);
  if (at + N > channel.values.size()) return value;
  for (int i = 0; i < N; ++i) value[i] = double{channel.values[at + static_cast<std::size_t>(i)]};
  return value;
}

template <int N>
Vector<N> valueOf(const AnimationChannel& channel, std::size_t key) {
  return read<N>(channel, key, channel.interpolation == Interpolation::Cubic ? 1 : 0);
}

// Evaluates glTF 2.0, C.5. Tangents are per second, while the spline parameter runs from 0 to 1.
template <int N>
Vector<N> cubicAt(const AnimationChannel& channel, const Place& at) {
  const double t = at.share, t2 = t * t, t3 = t2 * t;
  return (2.0 * t3 - 3.0 * t2 + 1.0) * read<N>(channel, at.first, 1) +
         at.interval_s * (t3 - 2.0 * t2 + t) * read<N>(channel, at.first, 2) +
         (3.0 * t2 - 2.0 * t3) * read<N>(channel, at.first + 1, 1) +
         at.interval_s * (t3 - t2) * read<N>(channel, at.first + 1, 0);
}

glm::dquat quaternion(const Vector<4>& xyzw) {
  return {xyzw.w, xyzw.x, xyzw.y, xyzw.z};
}

}  // namespace

glm::vec3 vectorAt(const AnimationChannel& channel, float time_s) {
  if (channel.times_s.empty()) return glm::vec3(0.0f);
  const Place at = placeOf(channel, time_s);
  const Vector<3> from = valueOf<3>(channel, at.first);
  if (at.share == 0.0 || channel.interpolation == Interpolation::Step) return glm::vec3(from);
  if (channel.interpolation == Interpolation::Cubic) return glm::vec3(cubicAt<3>(channel, at));
  return glm::vec3(glm::mix(from, valueOf<3>(channel, at.first + 1), at.share));
}

glm::quat rotationAt(const AnimationChannel& channel, float time_s) {
  if (channel.times_s.empty()) return {1.0f, 0.0f, 0.0f, 0.0f};
  const Place at = placeOf(channel, time_s);
  const auto unit = [](const glm::dquat& q) {
    const double length = glm::length(q);
    return length > 1e-12 ? q / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
  };
  const glm::dquat from = unit(quaternion(valueOf<4>(channel, at.first)));
  if (at.share == 0.0 || channel.interpolation == Interpolation::Step) return glm::quat(from);
  if (channel.interpolation == Interpolation::Linear)
    // glTF 2.0, C.4, along the shorter of the two arcs.
    return glm::quat(unit(glm::slerp(from, unit(quaternion(valueOf<4>(channel, at.first + 1))), at.share)));
  // A spline may pass through 0, where it defines no rotation.
  const glm::dquat q = quaternion(cubicAt<4>(channel, at));
  return glm::quat(glm::length(q) > 1e-6 ? unit(q) : from);
}

float durationOf(const Animation& animation) {
  float last = 0.0f;
  for (const AnimationChannel& channel : animation.channels)
    if (!channel.times_s.empty()) last = std::max(last, channel.times_s.back());
  return last;
}

void applyChannel(const AnimationChannel& channel, float time_s, Trs& parts) {
  if (channel.times_s.empty()) return;
  switch (channel.path) {
    case AnimationChannel::Path::Translation:
      parts.translation = vectorAt(channel, time_s);
      return;
    case AnimationChannel::Path::Rotation:
      parts.rotation = rotationAt(channel, time_s);
      return;
    case AnimationChannel::Path::Scale:
      parts.scale = vectorAt(channel, time_s);
      return;
  }
}

void applyAnimations(std::span<const Animation> animations, float time_s, std::vector<Node>& nodes) {
  std::vector<bool> moved(nodes.size(), false);
  for (const Animation& animation : animations)
    for (const AnimationChannel& channel : animation.channels) {
      if (channel.node >= nodes.size() || !nodes[channel.node].trs) continue;
      applyChannel(channel, time_s, *nodes[channel.node].trs);
      moved[channel.node] = true;
    }
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (moved[n]) nodes[n].parent_from_node = nodes[n].trs->matrix();
}

glm::mat4 Trs::matrix() const {
  glm::mat4 matrix = glm::mat4_cast(rotation);
  for (int column = 0; column < 3; ++column) matrix[column] *= scale[column];
  matrix[3] = glm::vec4(translation, 1.0f);
  return matrix;
}

std::vector<glm::mat4> worldTransforms(const std::vector<Node>& nodes) {
  std::vector<glm::dmat4> world_from_node(nodes.size(), glm::dmat4(1.0));
  std::vector<bool> done(nodes.size(), false);
  std::vector<std::size_t> chain;
  for (std::size_t start = 0; start < nodes.size(); ++start) {
    // The loop climbs to the first ancestor that is done and comes back down. It does not recurse, because
    // hierarchies may be deep.
    chain.clear();
    for (std::int32_t i = static_cast<std::int32_t>(start); i >= 0 && !done[static_cast<std::size_t>(i)];
         i = nodes[static_cast<std::size_t>(i)].parent) {
      chain.push_back(static_cast<std::size_t>(i));
      done[static_cast<std::size_t>(i)] = true;
    }
    while (!chain.empty()) {
      const std::size_t i = chain.back();
      chain.pop_back();
      const std::int32_t parent = nodes[i].parent;
      world_from_node[i] = glm::dmat4(nodes[i].parent_from_node);
      if (parent >= 0)
        world_from_node[i] = world_from_node[static_cast<std::size_t>(parent)] * world_from_node[i];
    }
  }
  return {world_from_node.begin(), world_from_node.end()};
}

}  // namespace lambent::gltf
