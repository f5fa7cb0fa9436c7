#include "runtime/ecs/registry.hpp"

#include <limits>

namespace lambent::ecs {

void SparseSetBase::append(Entity entity) {
  if (entity.index >= places_.size()) places_.resize(std::size_t{entity.index} + 1, kNoPlace);
  assert(places_[entity.index] == kNoPlace && "a component of a dead entity was left behind");
  places_[entity.index] = static_cast<std::uint32_t>(entities_.size());
  entities_.push_back(entity);
  versions_.push_back(++version_);
}

void SparseSetBase::removeAt(std::uint32_t place) {
  places_[entities_.back().index] = place;
  places_[entities_[place].index] = kNoPlace;
  entities_[place] = entities_.back();
  versions_[place] = versions_.back();
  entities_.pop_back();
  versions_.pop_back();
  ++version_;
}

Entity Registry::create() {
  std::uint32_t index = 0;
  if (free_.empty()) {
    assert(generations_.size() < Entity::kNoIndex && "out of entity indices");
    index = static_cast<std::uint32_t>(generations_.size());
    generations_.push_back(0);
  } else {
    index = free_.back();
    free_.pop_back();
  }
  return Entity{index, ++generations_[index]};
}

bool Registry::destroy(Entity entity) {
  if (!alive(entity)) return false;
  for (auto& [type, set] : sets_) set->remove(entity);
  // An index whose generations are used up is not reused, or its first handles would become valid again.
  const bool used_up = entity.generation == std::numeric_limits<std::uint32_t>::max();
  ++generations_[entity.index];
  if (!used_up) free_.push_back(entity.index);
  return true;
}

bool Registry::alive(Entity entity) const {
  return entity.index < generations_.size() && entity.generation % 2 == 1 &&
         generations_[entity.index] == entity.generation;
}

std::vector<Entity> Registry::entities() const {
  std::vector<Entity> all;
  for (std::uint32_t index = 0; index < generations_.size(); ++index) {
    if (generations_[index] % 2 == 1) all.push_back(Entity{index, generations_[index]});
  }
  return all;
}

SparseSetBase* Registry::findSet(const void* type) const {
  const auto it = sets_.find(type);
  return it == sets_.end() ? nullptr : it->second.get();
}

void Registry::addSet(const void* type, std::unique_ptr<SparseSetBase> set) {
  sets_.emplace(type, std::move(set));
}

}  // namespace lambent::ecs
