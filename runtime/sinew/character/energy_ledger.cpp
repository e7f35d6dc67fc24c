#include "sinew/character/energy_ledger.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kSlack = 0.02;  ///< of the kinetic energy: bdf2's value at an instant oscillates by less

/// Scales a tree's motion: all of it, or that relative to its centre of mass.
template <class T>
void slow(CharacterState<T>& s, double factor, bool about_center) {
  const Vec3<T> shared = about_center ? Vec3<T>((s.report.momentum / s.total_mass).template cast<T>())
                                      : Vec3<T>(Vec3<T>::Zero());
  s.history.slow(T(factor), shared);
  for (std::array<T, 6>& rate : s.rate)
    for (T& r : rate) r *= T(factor);
  s.steps_unchanged = 0;
}

/// A free body that touches nothing: its momenta are kept exactly, and the energy that they give swings by
/// h²|ω|² about the true one for ever.
template <class T>
bool flies_alone(std::span<CharacterState<T>* const> states) {
  const CharacterState<T>& s = *states[0];
  return states.size() == 1 && s.tree.dofs == 6 && s.tree.type[0] == JointType::kFree &&
         s.report.contacts == 0;
}

}  // namespace

template <class T>
double energy(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity) {
  double sum = 0;
  for (const CharacterState<T>* s : states) {
    const Totals t = totals<T>(s->tree, s->history, gravity);
    sum += t.kinetic_energy + t.potential_energy + s->report.elastic_energy;
  }
  return sum;
}

template <class T>
bool EnergyLedger<T>::settle(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity,
                             double before, bool strict) const {
  double now = 0, kinetic = 0, internal = 0, ceiling = 0;
  for (const CharacterState<T>* s : states) {
    const CharacterReport& r = s->report;
    now += r.kinetic_energy + r.potential_energy + r.elastic_energy;
    kinetic += r.kinetic_energy;
    internal += r.kinetic_energy - 0.5 * r.momentum.squaredNorm() / s->total_mass;
    ceiling += s->energy_ceiling;
  }
  const bool touching = std::any_of(states.begin(), states.end(),
                                    [](const CharacterState<T>* s) { return s->report.contacts > 0; });
  if (strict || !std::isfinite(ceiling)) ceiling = before;
  if (touching) ceiling = std::min(ceiling, before);  // what swings in flight does not in contact
  // Rounding of positions and momenta is no gain.
  const double noise = 64 * double(std::numeric_limits<T>::epsilon()) * (std::abs(now) + kinetic);
  const double gained = now - ceiling;
  const bool above = gained > noise && kinetic > 0;
  if (above) {
    const bool about_center = gained < 0.9 * internal;
    const double factor = std::sqrt(std::max(0.0, 1 - gained / (about_center ? internal : kinetic)));
    now = 0;
    for (CharacterState<T>* s : states) {
      slow(*s, factor, about_center);
      s->report_totals(gravity);
      now += s->report.kinetic_energy + s->report.potential_energy + s->report.elastic_energy;
    }
  }
  const double slack = flies_alone(states) ? ceiling - now : std::min(ceiling - now, kSlack * kinetic);
  const double spare = slack / double(states.size());  // below 0: rounding, which must not add up
  for (CharacterState<T>* s : states)
    s->energy_ceiling =
        s->report.kinetic_energy + s->report.potential_energy + s->report.elastic_energy + spare;
  return above;
}

template class EnergyLedger<float>;
template class EnergyLedger<double>;
template double energy<float>(std::span<CharacterState<float>* const>, const Vec3<double>&);
template double energy<double>(std::span<CharacterState<double>* const>, const Vec3<double>&);

}  // namespace sinew
