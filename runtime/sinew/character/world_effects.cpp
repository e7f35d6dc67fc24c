// What the host declares in a world besides characters and props.
#include <algorithm>
#include <atomic>

#include "sinew/character/world_impl.h"

namespace sinew {
namespace {

std::atomic<std::uint32_t> serials{0};  ///< given to effects so far, in all worlds

}  // namespace

template <class T>
Status World<T>::Impl::add_effect(CharacterState<T>& state, std::unique_ptr<Effect<T>> effect, EffectId* id) {
  if (id) *id = {};
  if (!effect) return Status::error(Code::kInvalidArgument, "no effect");
  if (Status status = effect->attach(state.skeleton, state.tree); !status) return status;
  state.problem.plan(*effect);
  auto slot = std::find_if(effect_slots.begin(), effect_slots.end(),
                           [](const EffectSlot<T>& s) { return s.serial == 0; });
  if (slot == effect_slots.end()) slot = effect_slots.insert(slot, EffectSlot<T>());
  *slot = {++serials, &state, effect.get()};
  if (id) *id = {static_cast<std::uint32_t>(slot - effect_slots.begin()), slot->serial};
  state.effects.push_back(std::move(effect));
  meet_surroundings();
  return {};
}

template <class T>
Status World<T>::add_effect(int character, std::unique_ptr<Effect<T>> effect, EffectId* id) {
  if (id) *id = {};
  CharacterState<T>* const s = impl_->character(character);
  return s ? impl_->add_effect(*s, std::move(effect), id) : no_such_character(character);
}

template <class T>
Status World<T>::add_prop_effect(int prop, std::unique_ptr<Effect<T>> effect, EffectId* id) {
  if (id) *id = {};
  CharacterState<T>* const s = impl_->prop(prop);
  return s ? impl_->add_effect(*s, std::move(effect), id) : no_such_prop(prop);
}

template <class T>
Effect<T>* World<T>::effect(EffectId id) const {
  const EffectSlot<T>* const slot = impl_->slot_of(id);
  return slot ? slot->effect : nullptr;
}

/// Of those that a tree has left, and of nothing else.
template <class T>
void World<T>::Impl::plan_effects_anew(CharacterState<T>& s) {
  s.problem.effects.clear();
  s.problem.effect_rows.clear();
  s.problem.stiff = false;
  for (const auto& effect : s.effects) s.problem.plan(*effect);
  s.levels.wake = true;
}

template <class T>
Status World<T>::remove_effect(EffectId id) {
  const EffectSlot<T>* const slot = impl_->slot_of(id);
  if (!slot) return Status::error(Code::kInvalidArgument, "no such effect, or it was taken away");
  CharacterState<T>& s = *slot->owner;
  std::erase_if(s.effects, [&](const auto& effect) { return effect.get() == slot->effect; });
  impl_->effect_slots[id.slot] = {};
  impl_->plan_effects_anew(s);
  return {};
}

template <class T>
Status World<T>::remove_effects(int character) {
  CharacterState<T>* const s = impl_->character(character);
  if (!s) return no_such_character(character);
  s->effects.clear();
  for (EffectSlot<T>& slot : impl_->effect_slots)
    if (slot.owner == s) slot = {};
  impl_->plan_effects_anew(*s);
  return {};
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

#define SINEW_WORLD_EFFECT_INSTANCES(T)                                                                  \
  template Status World<T>::Impl::add_effect(CharacterState<T>&, std::unique_ptr<Effect<T>>, EffectId*); \
  template void World<T>::Impl::plan_effects_anew(CharacterState<T>&);                                   \
  template Status World<T>::add_effect(int, std::unique_ptr<Effect<T>>, EffectId*);                      \
  template Status World<T>::add_prop_effect(int, std::unique_ptr<Effect<T>>, EffectId*);                 \
  template Effect<T>* World<T>::effect(EffectId) const;                                                  \
  template Status World<T>::remove_effect(EffectId);                                                     \
  template Status World<T>::remove_effects(int);                                                         \
  template void World<T>::Impl::declare(DeclareTerm<T>);                                                 \
  template Status World<T>::declare(DeclareTerm<T>);                                                     \
  template Status World<T>::declare(MakeIslandEffect<T>);
SINEW_WORLD_EFFECT_INSTANCES(float)
SINEW_WORLD_EFFECT_INSTANCES(double)

}  // namespace sinew
