#include "editor/document/field_edits.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <glm/geometric.hpp>

#include "runtime/scene/components.hpp"
#include "runtime/scene/materials.hpp"

namespace lambent::editor {

namespace {

bool isUsed(const scene::LocalLightComponent& light, std::string_view field) {
  using Kind = scene::LocalLightComponent::Kind;
  if (field == "radius") return light.kind == Kind::Sphere || light.kind == Kind::Disc;
  if (field == "range") return light.kind == Kind::Point || light.kind == Kind::Spot;
  if (field == "inner_cone" || field == "outer_cone") return light.kind == Kind::Spot;
  return true;
}

bool isUsed(const scene::CameraComponent& camera, std::string_view field) {
  if (field == "yfov" || field == "aspect") return camera.perspective;
  if (field == "xmag" || field == "ymag") return !camera.perspective;
  return true;
}

}  // namespace

bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field) {
  if (field.component == scene::LocalLightComponent::kComponentName)
    return isUsed(registry.get<scene::LocalLightComponent>(entity), field.name);
  if (field.component == scene::CameraComponent::kComponentName)
    return isUsed(registry.get<scene::CameraComponent>(entity), field.name);
  // Only matrices of files have shear; taken apart, others have a rounding error.
  if (field.component == scene::Transform::kComponentName && field.name == "shear")
    return glm::length(registry.get<scene::Transform>(entity).shear) > 1e-6f;
  if (field.component == scene::MaterialComponent::kComponentName && field.name == "anisotropy_rotation")
    return registry.get<scene::MaterialComponent>(entity).anisotropy > 0.0f;
  return true;
}

namespace {

constexpr int kDeepest = 32;  // parentheses and signs within each other

// Calculates sums and products of numbers, with parentheses.
class Calculation {
 public:
  explicit Calculation(std::string_view text) : rest_(text) {}

  std::optional<double> result() {
    const auto value = sum(0);
    skipBlanks();
    return value && rest_.empty() && std::isfinite(*value) ? value : std::nullopt;
  }

 private:
  void skipBlanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size())); }
  bool take(char wanted) {
    skipBlanks();
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::optional<double> sum(int depth) {
    auto value = product(depth);
    while (value) {
      const bool plus = take('+');
      if (!plus && !take('-')) break;
      const auto other = product(depth);
      value = other ? std::optional(plus ? *value + *other : *value - *other) : std::nullopt;
    }
    return value;
  }
  std::optional<double> product(int depth) {
    auto value = factor(depth);
    while (value) {
      const bool times = take('*');
      if (!times && !take('/')) break;
      const auto other = factor(depth);
      value = other ? std::optional(times ? *value * *other : *value / *other) : std::nullopt;
    }
    return value;
  }
  std::optional<double> factor(int depth) {
    if (depth > kDeepest) return std::nullopt;
    if (take('-')) {
      const auto value = factor(depth + 1);
      return value ? std::optional(-*value) : std::nullopt;
    }
    if (take('+')) return factor(depth + 1);
    if (take('(')) {
      const auto value = sum(depth + 1);
      return take(')') ? value : std::nullopt;
    }
    // from_chars also reads "inf" and "nan", which are no numbers here.
    if (rest_.empty() || rest_.find_first_of("0123456789.") != 0) return std::nullopt;
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc()) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  std::string_view rest_;
};

}  // namespace

double NumberEdit::appliedTo(double number) const {
  return kind == Kind::Set ? amount : kind == Kind::Add ? number + amount : number * amount;
}

std::optional<NumberEdit> parseNumberEdit(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  if (text.empty()) return std::nullopt;
  const char sign = text.front();
  const bool assigns = text.size() > 1 && text[1] == '=';
  // A number may begin with + or -, but not with * or /.
  const bool relative = sign == '*' || sign == '/' || ((sign == '+' || sign == '-') && assigns);
  const auto value = Calculation(relative ? text.substr(assigns ? 2 : 1) : text).result();
  if (!value) return std::nullopt;
  if (!relative) return NumberEdit{NumberEdit::Kind::Set, *value};
  if (sign == '/' && *value == 0.0) return std::nullopt;
  if (sign == '+' || sign == '-') return NumberEdit{NumberEdit::Kind::Add, sign == '+' ? *value : -*value};
  return NumberEdit{NumberEdit::Kind::Multiply, sign == '*' ? *value : 1.0 / *value};
}

}  // namespace lambent::editor
