#include "runtime/ecs/sparse_set.hpp"

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

}  // namespace lambent::ecs
