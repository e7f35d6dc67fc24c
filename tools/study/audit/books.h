// Books on a recorded motion: energies and momenta from where the bodies were, against the work that was put
// in. Nobody is asked for them: neither velocities nor energies of the simulation are read.
//
// Between impacts velocities are central differences of order 6 and 8, believed where differences of growing
// order converge. Near an impact they do not; there nothing is claimed but what the two steps that meet at an
// instant have in common. So `gain` and `rise` are the least by which the energy must have risen: a motion
// that keeps its energy has none, whatever its impacts, and what an impact adds is found as soon as it is
// over.
//
// One step's poses show more: the mean of a kinetic energy over a step is no less than that of the chord, and
// what a way below the chord saves in height it needs in speed. So a body that is put elsewhere, its velocity
// what it was, is found too: `leap`.
#pragma once

#include <deque>

#include "study/audit/differences.h"

namespace sinew::audit {

struct Momentum {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< kg·m/s
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< kg·m²/s, about the world's origin
  double linear_error = 0, angular_error = 0;
};

/// An energy's bounds, J.
struct Bounds {
  double low = 0, high = 0;
};

/// Of bodies from their velocities, and in gravity (m/s², world).
Bounds kinetic_energy(const Body& body, const Velocity& velocity);
/// J, least mean over a step of h seconds of a body's energy, kinetic and in gravity, between two poses:
/// whatever way it took. Of a body that falls freely (g h)²/6 per kg less than it has.
double least_energy(const Body& body, const Transform<double>& before, const Transform<double>& after,
                    double h, const Eigen::Vector3d& gravity, double precision);
double potential_energy(const Body& body, const Transform<double>& pose, const Eigen::Vector3d& gravity);
Momentum momentum_of(const Body& body, const Transform<double>& pose, const Velocity& velocity);

/// What the books show. Energies in J.
struct Balance {
  double kinetic_start = 0, kinetic_end = 0;
  double kinetic_most = 0;  ///< without what a step leaps by
  double gain = 0;          ///< most by which the total must have stood above its start plus the work put in
  double rise = 0;  ///< most by which it must have risen, beyond work, between instants that are seen, up to
                    ///< twelve steps apart
  double leap = 0;  ///< most by which the way of one step must have needed more than there was
  double unsure = 0;  ///< most that the books cannot tell at an instant between impacts: see `seen`
  double work = 0;    ///< put in
  int instants = 0;   ///< judged
  int seen = 0;       ///< of these, so well that the total is known to 1e-3 of the largest kinetic energy
  int blind =
      0;  ///< of the instants, those at which something turned by more than 1.5 rad in a step: not judged
};

class Books {
 public:
  /// `precision`: see velocity_at.
  Books(const Eigen::Vector3d& gravity, double precision) : gravity_(gravity), precision_(precision) {}

  /// Before the first record: a member with its poses now, and those `span` seconds before and after, as it
  /// would move by its speeds. Returns its index.
  int add(const Member& member, Poses before, Poses now, Poses after, double span);
  /// Something was done to the state from outside: the books start afresh at the next record.
  void forget();
  /// The state after a step of h seconds, of all members one after the other, and the work (J) that was put
  /// in during it; `unsure` is how far that may be off. Everything is looked at some steps later.
  void record(double h, const std::vector<Transform<double>>& poses, double work, double unsure = 0);

  const Balance& balance() const { return balance_; }
  /// Whether anybody's poses are known: there is a start, or a record since forget().
  bool begun() const { return !instants_.empty(); }
  /// J, over the last step, or at the start.
  double kinetic() const { return kinetic_; }
  const std::vector<Member>& members() const { return members_; }
  /// Of a member over the last step: the chord's.
  Momentum momentum(int member) const;
  /// Of all members four steps ago, by differences: exact to their error. Zero before there are so many.
  const Momentum& momentum_between_impacts() const { return momentum_; }
  /// Where a member's bodies were after the last record.
  Poses poses(int member) const;
  /// Velocity of a point (body axes) of a member after the last record, or at the start. Infinitely unsure
  /// where nothing is known of it: right after forget().
  Estimate arriving(int member, int body, const Eigen::Vector3d& point) const;

 private:
  struct Instant {
    double time = 0, work = 0, unsure = 0;  ///< sums since the start
    std::vector<Transform<double>> poses;   ///< of all members
  };
  void look_at_step();
  double leap_of_step() const;
  double hidden(const Body& body, const Velocity& velocity, double h) const;
  void judge_instant(double turn_at_start);
  void enter(const Bounds& energy, const Instant& at);
  std::vector<double> times() const;
  std::vector<Transform<double>> history(std::size_t body) const;

  Eigen::Vector3d gravity_;
  double precision_;
  std::vector<Member> members_;
  std::vector<std::size_t> first_;  ///< [member] of its bodies among all
  std::vector<Body> bodies_;        ///< of all members
  std::deque<Instant> instants_;
  std::vector<Transform<double>> before_start_;  ///< of all members; empty once the start is out of sight
  double before_start_span_ = 0;                 ///< s
  std::deque<double> highs_;                     ///< upper bounds of the last instants, less the work
  double base_ = 0;                              ///< J, most that the start may have had
  bool based_ = false;
  double kinetic_ = 0;
  double fastest_ = 0;  ///< rad/s, of any body at the start
  Momentum momentum_;
  Balance balance_;
};

}  // namespace sinew::audit
