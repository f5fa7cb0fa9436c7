// A View iterates over the entities that have all of some components:
//   for (auto [entity, transform, draw] : registry.view<Transform, const DrawItem>()) ...
//
// The loop may create, destroy, add and remove anything. It walks a list of entities that was copied from the
// smallest set when the view was made. It visits an entity once, if it still has every component when its
// turn comes, and does not visit entities that were added meanwhile. (Walking the set itself would skip or
// repeat entities, since removal moves them.) References are valid until the loop body adds or removes a
// component of that type.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <vector>

#include "runtime/ecs/sparse_set.hpp"

namespace lambent::ecs {

template <class... Ts>
class View {
  static_assert(sizeof...(Ts) > 0);
  // A const T needs a const set.
  template <class T>
  using SetOf = std::conditional_t<std::is_const_v<T>, const SparseSet<std::remove_const_t<T>>, SparseSet<T>>;

 public:
  // A set is null if no entity ever had the component. The view is then empty.
  explicit View(SetOf<Ts>*... sets) : sets_(sets...) {
    const std::array<const SparseSetBase*, sizeof...(Ts)> all{sets...};
    if (std::find(all.begin(), all.end(), nullptr) != all.end()) return;
    const SparseSetBase* smallest = *std::min_element(
        all.begin(), all.end(), [](const auto* a, const auto* b) { return a->size() < b->size(); });
    entities_.assign(smallest->entities().begin(), smallest->entities().end());
  }

  class Iterator {
   public:
    Iterator(const View& view, std::size_t at) : view_(&view), at_(at) { settle(); }
    std::tuple<Entity, Ts&...> operator*() const {
      return std::apply(
          [&](auto*... values) { return std::tuple<Entity, Ts&...>(view_->entities_[at_], *values...); },
          found_);
    }
    Iterator& operator++() {
      ++at_;
      settle();
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    // Moves from at_ to the next entity that has all components.
    void settle() {
      for (; at_ < view_->entities_.size(); ++at_) {
        const Entity entity = view_->entities_[at_];
        found_ = std::apply([&](auto*... sets) { return std::tuple<Ts*...>(sets->find(entity)...); },
                            view_->sets_);
        if (std::apply([](auto*... values) { return (... && (values != nullptr)); }, found_)) return;
      }
    }

    const View* view_;
    std::size_t at_;
    std::tuple<Ts*...> found_;
  };

  Iterator begin() const { return Iterator(*this, 0); }
  Iterator end() const { return Iterator(*this, entities_.size()); }

 private:
  std::tuple<SetOf<Ts>*...> sets_;
  std::vector<Entity> entities_;
};

}  // namespace lambent::ecs
