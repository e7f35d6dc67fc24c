// What is pushed takes up all of the push.
#include <gtest/gtest.h>

#include "character/scenes.h"

namespace sinew {
namespace {

constexpr double kStep = 1 / 60.0;

/// Momentum (kg·m/s) of a limp figure in free flight half a second after a push (N·s) at its chest.
template <class T>
Vec3<double> pushed_in_flight(const Vec3<double>& impulse) {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  fixtures::Limp<T> limp(settings, 0, 1e-6, 1);
  Character<T> figure = limp.world.character(0);
  for (int n = 0; n < 45; ++n) {
    if (n == 15) {
      const Vec3<T> chest = figure.model()[0].translation;
      EXPECT_TRUE(figure.apply_impulse(0, chest, impulse.template cast<T>()).ok());
    }
    EXPECT_TRUE(limp.world.step(T(kStep)).ok());
  }
  return figure.report().momentum;
}

TEST(Push, GivesALimpFigureInFlightItsWholeMomentum) {
  // The backward difference takes in two thirds of it in the step itself and the rest in those after, which
  // must not pass for energy from nowhere: 3^-8 of it may, and the solver's tolerance.
  const Vec3<double> impulse(60, 20, -30);
  EXPECT_LT((pushed_in_flight<double>(impulse) - impulse).norm(), 1e-3 * impulse.norm());
  EXPECT_LT((pushed_in_flight<float>(impulse) - impulse).norm(), 1e-3 * impulse.norm());
}

}  // namespace
}  // namespace sinew
