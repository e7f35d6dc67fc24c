#include "sinew/character/energy_balance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

constexpr double kSlack = 0.02;  ///< of the kinetic energy: what it swings by from step to step is less

/// Of the energy of limbs moving against each other: the most that one step may give and take.
constexpr double kMostGiven = 0.2, kMostTaken = 0.9;
/// Where that energy is below the first share of all about the centre of mass, it bears no change, from the
/// second on all of it: in a figure that turns as if rigid, what swings is the turning.
constexpr double kTooRigid = 1e-3, kLooseEnough = 1e-2;

constexpr double kNoSpin = 1e-30;  ///< rad/s: not worth keeping, see set_momentum

double total(const CharacterReport& r) {
  return r.kinetic_energy + r.potential_energy + r.elastic_energy;
}

/// What it has, without the work of depenetration that is not paid back to it.
template <class T>
double owned(const CharacterState<T>& s) {
  return total(s.report) - s.depenetration_energy;
}

/// What rounded positions and momenta make of its energy, J: no gain. In T, wherever it is, for its place is
/// kept in double precision, and energies are summed in that.
template <class T>
double rounding(const CharacterState<T>& s, const Vec3<double>& gravity) {
  T reach = T(0);  // m²
  for (const Vec3<T>& center : s.history.center) reach = std::max(reach, center.squaredNorm());
  const double weight = s.total_mass * gravity.norm() * std::sqrt(double(reach));
  return 4 * double(std::numeric_limits<T>::epsilon()) *
             (s.report.kinetic_energy + s.report.elastic_energy + weight) +
         16 * std::numeric_limits<double>::epsilon() * std::abs(total(s.report));
}

/// Scales a tree's motion relative to a rigid one, and turns it faster.
template <class T>
void change(CharacterState<T>& s, const RigidMotion& rigid, T factor,
            const Vec3<double>& turn = Vec3<double>::Zero()) {
  change_motion<T>(s.tree, rigid, factor, turn, s.history);
  for (std::array<T, 6>& rate : s.rate)
    for (T& r : rate) r *= factor;
  s.read_root_rate();
}

/// m/s, of the centre of mass of all.
template <class T>
Vec3<double> common_velocity(std::span<CharacterState<T>* const> states) {
  double mass = 0;
  Vec3<double> momentum = Vec3<double>::Zero();
  for (const CharacterState<T>* s : states) {
    mass += s->total_mass;
    momentum += s->report.momentum;
  }
  return momentum / mass;
}

/// J, of the motion relative to a velocity.
template <class T>
double kinetic_about(const CharacterState<T>& s, const Vec3<double>& velocity) {
  const CharacterReport& r = s.report;
  return r.kinetic_energy - r.momentum.dot(velocity) + 0.5 * s.total_mass * velocity.squaredNorm();
}

/// Scales a tree's motion relative to a velocity.
template <class T>
void slow(CharacterState<T>& s, double factor, const Vec3<double>& velocity) {
  RigidMotion kept;
  kept.velocity = velocity;
  change(s, kept, T(factor));
}

template <class T>
bool is_rigid(const CharacterState<T>& s) {
  return s.tree.dofs == 6 && s.tree.type[0] == JointType::kFree;
}

/// The work of depenetration that a tree has got and is not stored any more has become motion, lost its way
/// or lifted something: pays as much of it back, with this tree's motion relative to `still`, as the trees
/// have above their ceiling.
template <class T>
void pay_back(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity, double ceiling,
              const Vec3<double>& still) {
  double surplus = -ceiling;
  for (const CharacterState<T>* s : states) surplus += total(s->report);
  for (CharacterState<T>* s : states) {
    const double kinetic = kinetic_about(*s, still),
                 spent = s->depenetration_energy - s->report.elastic_energy;
    const double paid = std::min({spent, surplus, kinetic});
    if (!(paid > 0)) continue;
    slow(*s, std::sqrt(1 - paid / kinetic), still);
    s->report_totals(gravity);
    s->depenetration_energy -= paid;
    surplus -= paid;
  }
}

/// Takes out what the trees have above their ceiling; where nothing outside holds them, they keep what they
/// have of momentum together. True if there was something.
template <class T>
bool limit(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity, double before,
           bool strict, bool never_rises, bool afloat) {
  const Vec3<double> still = afloat ? common_velocity(states) : Vec3<double>(Vec3<double>::Zero());
  double now = 0, kinetic = 0, loose = 0, internal = 0, ceiling = 0, rounded = 0;
  for (const CharacterState<T>* s : states) ceiling += s->energy_ceiling;
  if (strict || !std::isfinite(ceiling)) ceiling = before;
  if (never_rises)
    ceiling = std::min(ceiling, before);  // what swings in flight and loops does not in contact
  pay_back(states, gravity, ceiling, still);
  for (const CharacterState<T>* s : states) {
    const CharacterReport& r = s->report;
    now += owned(*s);
    kinetic += r.kinetic_energy;
    loose += kinetic_about(*s, still);
    rounded += rounding(*s, gravity);
    internal += r.kinetic_energy - 0.5 * r.momentum.squaredNorm() / s->total_mass;
  }
  const double gained = now - ceiling;
  const bool above = gained > rounded && loose > 0;
  if (above) {
    const bool about_center = gained < 0.9 * internal;
    const double factor = std::sqrt(std::max(0.0, 1 - gained / (about_center ? internal : loose)));
    now = 0;
    for (CharacterState<T>* s : states) {
      slow(*s, factor, about_center ? Vec3<double>(s->report.momentum / s->total_mass) : still);
      s->report_totals(gravity);
      now += owned(*s);
    }
  }
  const bool rigid =
      std::all_of(states.begin(), states.end(), [](const CharacterState<T>* s) { return is_rigid(*s); });
  const double slack = rigid ? ceiling - now : std::min(ceiling - now, kSlack * kinetic);
  const double spare = slack / double(states.size());  // below 0: rounding, which must not add up
  for (CharacterState<T>* s : states) {
    s->depenetration_energy =
        std::min(s->depenetration_energy,
                 s->report.elastic_energy);  // the rest has been lost, or has lifted something
    s->energy_ceiling = owned(*s) + spare;
  }
  return above;
}

/// What rubs or damps within a joint: a force that is constant over the step.
template <class T>
bool rubs(const JointRow<T>& row) {
  return row.scalar == RowScalar::kFromStart && !row.muscle;
}

/// Nothing takes energy but what rubs within joints, no limit bears or bore, and the scheme is one that
/// nearly conserves.
template <class T>
bool accounts_for_all(const CharacterState<T>& s) {
  const std::vector<JointRow<T>>& rows = s.problem.rows;
  return s.history.accelerates && s.steps_unchanged > 0 && s.report.elastic_energy == 0 &&
         s.problem.effects.empty() && std::all_of(rows.begin(), rows.end(), [](const JointRow<T>& row) {
           return row.kind == RowKind::kOneSided || rubs(row);
         });
}

/// J, that what rubs within joints has taken in the step.
template <class T>
double rubbed(const CharacterState<T>& s) {
  double sum = 0;
  for (const JointRow<T>& row : s.problem.rows)
    if (rubs(row)) sum += double(row.slope(row.value) * row.value);
  return sum / double(constant_emphasis(s.problem.prediction.weight, s.rate_step));
}

}  // namespace

/// Gives a tree that nothing but gravity acts on the angular momentum that it had; one that is lossless too
/// the energy that it had but for what rubbed, and takes from any other what it gained, as far as the motion
/// of its limbs against each other can bear the change.
template <class T>
void EnergyBalance<T>::keep_in_flight(CharacterState<T>& s, const Vec3<double>& gravity,
                                      const Before& before) {
  if (is_rigid(s) || s.tree.type[0] != JointType::kFree) return;
  const CharacterReport& r = s.report;
  Totals sums;
  sums.kinetic_energy = r.kinetic_energy;
  sums.momentum = r.momentum;
  sums.angular_momentum = r.angular_momentum;
  const RigidMotion rigid = rigid_motion<T>(s.tree, s.history, sums);
  Vec3<double> turn = Vec3<double>::Zero();
  if (s.left_to_gravity) turn = rigid.spin_of(before.angular_momentum - r.angular_momentum);
  const double turned = turn.dot(r.angular_momentum + 0.5 * rigid.inertia * turn);  // J, that it gives
  const double now = owned(s) + turned, rounded = rounding(s, gravity);
  const bool keeps = accounts_for_all(s);
  // Kept at a mark of its own, which sinks by more than roundings may lift what is measured against it: these
  // add up neither to a gain nor to a loss.
  if (keeps) {
    if (!(std::abs(s.energy_ceiling - before.energy) < rounded / 2)) s.energy_ceiling = before.energy;
    s.energy_ceiling -= rounded / 8 + rubbed(s);
  }
  const double missing = (keeps ? s.energy_ceiling : before.energy - rounded) - now;
  const double about_center = r.kinetic_energy + turned - 0.5 * r.momentum.squaredNorm() / s.total_mass;
  const double loose = (rigid.relative_energy / about_center - kTooRigid) / (kLooseEnough - kTooRigid);
  double share = 0;
  if (loose > 0 && (keeps || missing < 0))
    share = std::clamp(std::min(loose, 1.0) * missing / rigid.relative_energy, -kMostTaken, kMostGiven);
  if (share == 0 && turn.isZero(kNoSpin)) return;
  change(s, rigid, T(std::sqrt(1 + share)), turn);
  s.report.kinetic_energy += turned + share * rigid.relative_energy;
  s.report.angular_momentum += rigid.inertia * turn;
}

template <class T>
double EnergyBalance<T>::open(std::span<CharacterState<T>* const> states, const Vec3<double>& gravity) {
  before_.clear();
  double sum = 0;
  for (const CharacterState<T>* s : states) {
    const Totals t = totals<T>(s->tree, s->history, gravity);
    const double energy = t.kinetic_energy + t.potential_energy + s->report.elastic_energy;
    const bool begins = s->history.step_before == T(0) && s->contact_signature == 0;
    before_.push_back(
        {energy - s->depenetration_energy, t.angular_momentum, begins || s->depenetration_energy > 0});
    sum += energy;
  }
  return sum;
}

template <class T>
bool EnergyBalance<T>::close(std::span<CharacterState<T>* const> states, std::span<const Contact<T>> contacts,
                             const Vec3<double>& gravity, bool strict, bool tied, bool exchanged) const {
  for (const Contact<T>& c : contacts)
    if (before_[c.tree_a].depenetrates)
      states[c.tree_a]->depenetration_energy += double(c.depenetration_work);
  const bool touching =
      exchanged || std::any_of(states.begin(), states.end(),
                               [](const CharacterState<T>* s) { return s->report.contacts > 0; });
  if (touching || tied || strict) {
    const double before = std::accumulate(before_.begin(), before_.end(), 0.0,
                                          [](double sum, const Before& b) { return sum + b.energy; });
    const bool afloat = !tied && !strict && std::none_of(contacts.begin(), contacts.end(), [](const auto& c) {
      return c.tree_b < 0 && c.acts();
    });
    return limit<T>(states, gravity, before, strict, touching && !tied, afloat);
  }
  bool damped = false;
  for (std::size_t n = 0; n < states.size(); ++n) {
    keep_in_flight(*states[n], gravity, before_[n]);
    // The flight of what is rigid is exact: it never rises.
    damped = limit<T>(states.subspan(n, 1), gravity, before_[n].energy, false, is_rigid(*states[n]), false) ||
             damped;
  }
  return damped;
}

template class EnergyBalance<float>;
template class EnergyBalance<double>;

}  // namespace sinew
