// Tells which fields of a component mean something with its present values: a point light has no radius, and
// only a spot light has cones. Inspectors leave the others out. Files and scripts have all fields.
#pragma once

#include "runtime/ecs/registry.hpp"
#include "runtime/scene/reflection.hpp"

namespace lambent::editor {

// The entity must have the field's component.
bool isUsed(const ecs::Registry& registry, ecs::Entity entity, const scene::FieldInfo& field);

}  // namespace lambent::editor
