// Velocities at the end of a step: those that joints and contacts allow.
//
// The scheme leaves every body a momentum of its own (bossak.h). Of all velocities that the joints allow,
// those with these momenta in the joints' freedom are the nearest by the mass matrix: u = M⁻¹Jᵀ(m v*, L*).
// Where an impulse has just closed a contact or a joint's limit, it may not close further either: impulses p
// ≥ 0 take out what of u does, projected Gauss-Seidel over (n·J) u ≥ 0 (Acary, "Projected event-capturing
// time-stepping schemes for nonsmooth mechanical systems", 2013). Nor may it slide, as far as Coulomb's cone
// of that impulse allows: friction in the step itself goes by the smooth force that there was when it began.
// What is driven into a loop moves as it is driven. All are projections: none adds energy.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sinew/effects/coupling.h"
#include "sinew/optimizer/problem.h"
#include "sinew/residual/articulated_matrix.h"

namespace sinew {

/// Velocity of a body relative to its parent, as tree.h has spatial motions.
template <class T>
struct Twist {
  Vec3<T> w = Vec3<T>::Zero();  ///< rad/s, world axes
  Vec3<T> v = Vec3<T>::Zero();  ///< of the material point at the common origin, m/s

  Vec3<T> at(const Vec3<T>& point) const { return v + w.cross(point); }
};

template <class T>
class EndVelocities {
 public:
  void reserve(const SolveCapacity& capacity);
  /// That reserve() takes.
  static std::size_t bytes(const SolveCapacity& capacity);

  /// Factorises the mass matrices of the trees over their `loose` degrees of freedom [dof, trees one after
  /// the other] at the problems' kinematics, as if every other joint were locked. Uses the problems'
  /// composites. O(bodies + unknowns).
  void begin(std::span<TreeProblem<T>* const> problems, std::span<const std::uint8_t> loose);
  /// Whether a degree of freedom of a tree is.
  bool loose(int tree, int dof) const { return of_dof_[parts_[tree].first_dof + dof] >= 0; }

  /// J M⁻¹ q: how far the generalised forces `force` [dof] (N·m, N) move a tree's bodies, per unit of mass
  /// matrix. `moved` and `turned` [body] are written. O(bodies).
  void respond(int tree, std::span<const T> force, std::span<Vec3<T>> moved, std::span<Vec3<T>> turned);

  /// Joint rates [body] of the last answer of respond() or missed() for this tree, as joint offsets'; 0 where
  /// no unknown moves the joint.
  void answered(int tree, std::span<std::array<T, 6>> rate);

  /// Takes out of generalised forces or impulses [dof] what the matrix' floor (composite.h) keeps from moving
  /// anything, as it does for respond(): M of what its factor makes of them. `answered`: they are so many
  /// times what respond() has just been asked about; 0: something else. O(bodies).
  void remove_floor_share(int tree, std::span<T> force, T answered);

  /// Finds the rates of a tree's unknowns from the momenta of its history and the impulses `impulse` [dof]
  /// (N·m·s, N·s; empty: none), whose response M⁻¹ need not be found to be projected: JᵀmJM⁻¹ is 1. Joints
  /// that no unknown moves have the velocities `driven` [body]. It solves for the change of `rate` [body],
  /// near to the answer, for the matrix has a floor (composite.h). Uses the problem's wrenches. O(bodies).
  void project(int tree, std::span<const Twist<T>> driven, std::span<const std::array<T, 6>> rate,
               std::span<const T> impulse, const History<T>& history);

  /// A contact may not close, as far as an impulse of `most` (N·s) can see to that; nor slide, as far as
  /// friction by that impulse and `cone` beside it (N·s) can, of which `rubbed` (on body a, world axes) has
  /// been done.
  void add(const Contact<T>& contact, T most, T cone, const Vec3<T>& rubbed);
  /// Nor may an element of a coupling stretch, or move but as it is driven.
  void add(const Coupling<T>& coupling, const Stencil<T>& element);
  /// Nor may the scalar of a tree's joint row grow.
  void add(int tree, const JointRow<T>& row, T most);
  /// Impulses that see to that. O(those that act · the depth of their bodies).
  void press();
  /// Calls visit(Contact::id, N·s) for all contacts that press() or strike() has pushed apart since begin().
  template <class Visit>
  void for_each_pushed(const Visit& visit) const {
    for (const Row& row : pressed_) {
      const T pushed = row.struck > T(0) ? row.struck : row.impulse;
      if (row.contact != 0 && pushed > T(0)) visit(row.contact, pushed);
    }
  }

  /// A contact that may strike within a step that begins here, after its gap, at its speed and `drift` (m/s),
  /// and then parts.
  void add_striking(const Contact<T>& contact, T drift, const Bounce<T>& bounce);
  /// One that bears: what strikes elsewhere lets it close no faster than it does.
  void add_bearing(const Contact<T>& contact);
  /// An element of a loop: what strikes elsewhere moves both of its sides.
  void add_tied(const Coupling<T>& coupling, const Stencil<T>& element);
  /// A limit of a tree's joint, which at more than `slow` (rad/s, m/s of a human) may strike; or, where it
  /// has been reached and does not close (`bears`), bears.
  void add_limit(int tree, const JointRow<T>& row, bool bears, T slow);
  /// Lets contacts that close faster than `slow` (m/s) strike one after the other within h: each is stopped,
  /// or sent back, with what friction its impulse allows, and with it all that lies on by then; but what
  /// bounces is struck only when it closes itself, so that a row of balls hands a blow on. False: none does.
  /// O(those that strike · those that lie on · the depth of their bodies).
  bool strike(T h, T slow);
  /// Whether that has changed a tree's velocities.
  bool struck(int tree) const { return disturbed_[tree] != 0; }
  /// By how much it has changed the rates of a tree's joints [body].
  void strike_changed(int tree, std::span<std::array<T, 6>> rate);
  /// By how much the bodies [body] move less in the step than at the velocities that it left, m/s and rad/s,
  /// for those come about within it. After write().
  void missed(int tree, std::span<Vec3<T>> moved, std::span<Vec3<T>> turned);

  /// The velocities into a tree's history, and those of its unknowns into `rate` [body].
  void write(int tree, History<T>& history, std::span<std::array<T, 6>> rate);

 private:
  void read_rates(int tree, std::span<std::array<T, 6>> rate);

  static constexpr std::size_t kMost = 3 * 64;  ///< rows: that may not close, or slide

  struct Part {
    int first_body = 0, first_dof = 0, first = 0, count = 0;  ///< unknowns
    ArticulatedParts<T> matrix;
  };
  struct Row {
    std::uint64_t contact = 0;  ///< whose normal it is
    int tree[2] = {-1, -1};
    int entry[2] = {0, 0},
        count[2] = {0, 0};           ///< of a side in `rows_`: its tree's unknowns, to the last that acts
    int grips = 0;                   ///< 2: the next two rows are those of its friction
    T friction = T(0), cone = T(0);  ///< μ; N·s, beside what its own impulse allows
    T given = T(0);     ///< m/s or rad/s, of joints that no unknown moves; then of all, before impulses
    T unit = T(1);      ///< m/s or rad/s, by a human's: see Scale
    T mobility = T(0);  ///< 1/kg
    T impulse = T(0);   ///< N·s, N·m·s
    T struck = T(0);    ///< the same of all strikes
    T least = T(0), most = T(0);  ///< of it
    T gap = T(0), drift = T(0);   ///< m, m/s or rad, rad/s; see add_striking()
    T size = T(1);                ///< m or rad, by a human's
    T slow = T(0);                ///< m/s or rad/s of a human: more slowly it does not strike
    T floor = T(0);               ///< m/s or rad/s: that it opens by at least
    Bounce<T> bounce;
    bool bears = false;    ///< see add_bearing() and add_tied()
    bool acts = false;     ///< in the present strike
    bool reduced = false;  ///< its entries and mobility are known
    int sides() const { return tree[1] < 0 ? 1 : 2; }
  };

  void move(int tree);
  void read_near(int tree, std::span<const std::array<T, 6>> rate);
  std::span<T> rates(int tree) { return std::span(rates_).subspan(parts_[tree].first, parts_[tree].count); }
  Row* open_row(int tree, int other);
  bool add_side(Row& row, int n);
  Row* add_point(const Contact<T>& contact, const Vec3<T>& point, const Vec3<T>& direction);
  void add_stencil(const Coupling<T>& coupling, const Stencil<T>& element, const Vec3<T>& direction, T speed,
                   T least);
  T opening(Row& row);
  void begin_pressing();
  T press_row(Row& row);
  bool closes(const Row& row, T opens, T slow) const;
  T wait_for_strike(T left, T slow);
  void choose_floor(Row& row, T slow, T share);
  void spread();
  bool reduce(Row& row);
  void push(Row& row, T change);
  void begin_side(int tree);
  std::span<T> side(const Row& row, int n) { return std::span(rows_).subspan(row.entry[n], row.count[n]); }
  void project_point(int tree, int body, const Vec3<T>& point, const Vec3<T>& normal, T sign);

  std::span<TreeProblem<T>* const> problems_;
  std::vector<Part> parts_;  ///< [tree]
  std::vector<int> of_dof_, dof_;
  std::vector<JointBlock> blocks_;
  std::vector<int> first_;
  std::vector<SpatialVector<T>> axes_, moved_, reduced_, force_, motion_;
  std::vector<JointBlockRow<T>> own_, factor_;
  std::vector<SpatialForm<T>> eliminated_;
  std::vector<T> rates_, near_, projection_;
  std::vector<Twist<T>> driven_, twist_;  ///< [body] of the joint alone; of the body
  std::vector<Row> pressed_;
  std::vector<T> rows_;  ///< what a unit of each unknown's rate makes of a row's speed: J; once it acts L⁻ᵀJᵀ
  std::vector<T> row_;                 ///< [unknown] of one side
  std::vector<std::uint8_t> on_path_;  ///< [body] the same
  std::vector<T> done_;  ///< [unknown] L⁻ᵀ times the impulses: M⁻¹ of them is L⁻¹ of this
  std::vector<T> before_,
      late_;  ///< [unknown] the same before a strike; of all, by the share of h until then
  std::vector<std::uint8_t> disturbed_;  ///< [tree] it is not 0
};

extern template class EndVelocities<float>;
extern template class EndVelocities<double>;

}  // namespace sinew
