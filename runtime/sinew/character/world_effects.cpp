// What the host declares in a world besides characters and props.
#include <algorithm>

#include "sinew/character/world_impl.h"

namespace sinew {

template <class T>
Status World<T>::Impl::add_effect(CharacterState<T>& state, std::unique_ptr<Effect<T>> effect) {
  if (!effect) return Status::error(Code::kInvalidArgument, "no effect");
  if (Status status = effect->attach(state.skeleton, state.tree); !status) return status;
  state.problem.plan(*effect);
  state.effects.push_back(std::move(effect));
  meet_surroundings();
  return {};
}

template <class T>
Status World<T>::add_effect(int character, std::unique_ptr<Effect<T>> effect) {
  return impl_->add_effect(*impl_->states[impl_->characters[character]], std::move(effect));
}

template <class T>
Status World<T>::add_prop_effect(int prop, std::unique_ptr<Effect<T>> effect) {
  return impl_->add_effect(*impl_->states[impl_->props[prop]], std::move(effect));
}

template <class T>
void World<T>::remove_effects(int character) {
  CharacterState<T>& s = *impl_->states[impl_->characters[character]];
  s.problem.effects.clear();
  s.problem.effect_rows.clear();
  s.problem.stiff = false;
  s.effects.clear();
  s.levels.wake = true;
}

/// Set-up, at any time.
template <class T>
void World<T>::Impl::declare(DeclareTerm<T> term) {
  term(plan);
  for (const auto& worker : workers) {
    worker->stepper.declare(plan);
    if (plan.make_checks && !worker->checks) worker->checks = plan.make_checks();
  }
  meet_surroundings();
}

template <class T>
Status World<T>::declare(DeclareTerm<T> term) {
  if (!impl_->states.empty())
    return Status::error(Code::kInvalidArgument, "to be declared before the first character");
  impl_->declare(term);
  return {};
}

template <class T>
Status World<T>::declare(MakeIslandEffect<T> make) {
  std::vector<MakeIslandEffect<T>>& declared = impl_->declared;
  if (std::find(declared.begin(), declared.end(), make) != declared.end()) return {};
  for (const auto& worker : impl_->workers) worker->stepper.declare(make());
  if (impl_->over_cap()) {
    for (const auto& worker : impl_->workers) worker->stepper.drop_last_effect();
    return Status::error(Code::kOutOfRange, "WorldSettings::memory_cap leaves no room for it");
  }
  declared.push_back(make);
  impl_->meet_surroundings();
  return {};
}

#define SINEW_WORLD_EFFECT_INSTANCES(T)                                                       \
  template Status World<T>::Impl::add_effect(CharacterState<T>&, std::unique_ptr<Effect<T>>); \
  template Status World<T>::add_effect(int, std::unique_ptr<Effect<T>>);                      \
  template Status World<T>::add_prop_effect(int, std::unique_ptr<Effect<T>>);                 \
  template void World<T>::remove_effects(int);                                                \
  template void World<T>::Impl::declare(DeclareTerm<T>);                                      \
  template Status World<T>::declare(DeclareTerm<T>);                                          \
  template Status World<T>::declare(MakeIslandEffect<T>);
SINEW_WORLD_EFFECT_INSTANCES(float)
SINEW_WORLD_EFFECT_INSTANCES(double)

}  // namespace sinew
