// Contacts of all kinds, with friction, as a world declares them.
#pragma once

#include "sinew/effects/step_plan.h"

namespace sinew {

/// What World::declare takes. Without, everything passes through everything: WorldSettings::ground must be
/// false, obstacles are refused.
template <class T>
struct Contacts {
  /// Fills in the plan's entries of contacts; set-up.
  static void declare(StepPlan<T>& plan);
};

extern template struct Contacts<float>;
extern template struct Contacts<double>;

}  // namespace sinew
