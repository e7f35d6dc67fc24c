// Levels from step to step, and the budget that caps them. Internal to the character layer.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sinew/character/state.h"

namespace sinew {

/// What a character may get now.
template <class T>
Level allowed_level(const CharacterState<T>& state);

/// What an island's step has done with one of its members.
template <class T>
Level level_of(const CharacterState<T>& state);

/// After a step that did `needed` with it: up at once, down when it was not needed for `dwell` seconds.
template <class T>
void choose_level(CharacterState<T>& state, Level needed, T h, double dwell);

/// Units of work of what the last step did with a character or prop.
template <class T>
double work_of(const CharacterState<T>& state, Level did);

/// What the budget remembers from step to step.
struct BudgetState {
  double forecast = 0;      ///< sum of the characters' smoothed costs
  float scale = 1;          ///< µs (or whatever the clock counts) per unit of work
  int over = 0, under = 0;  ///< steps above the limit, and well below it
};

/// Caps the least significant characters while the forecast is above the limit, and takes the caps off again,
/// the most significant first, when there is room.
template <class T>
class BudgetController {
 public:
  /// Set-up for so many states; nothing allocates afterwards.
  void reserve(int states);
  /// After a step of h seconds, whose costs the states hold. O(states), and a sort where something changes.
  void update(std::span<const std::unique_ptr<CharacterState<T>>> states, const LevelOfDetail& detail, T h,
              WorldReport& report);
  BudgetState& state() { return state_; }

 private:
  void lower(std::span<const std::unique_ptr<CharacterState<T>>> states, double limit);
  void raise(std::span<const std::unique_ptr<CharacterState<T>>> states, double limit, double dwell);

  float cost_at(const CharacterState<T>& state, Level level) const;

  BudgetState state_;
  std::vector<int> order_;  ///< characters, the least significant first
};

#define SINEW_LEVEL_INSTANCES(prefix, T)                             \
  prefix Level allowed_level<T>(const CharacterState<T>&);           \
  prefix Level level_of<T>(const CharacterState<T>&);                \
  prefix void choose_level<T>(CharacterState<T>&, Level, T, double); \
  prefix double work_of<T>(const CharacterState<T>&, Level);         \
  prefix class BudgetController<T>;
SINEW_LEVEL_INSTANCES(extern template, float)
SINEW_LEVEL_INSTANCES(extern template, double)

}  // namespace sinew
