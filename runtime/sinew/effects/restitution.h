// Restitution: what an impact took is given back in part, as velocities.
//
// What strikes while it flies, or falls, parts where it strikes, before the solve (Impacts, optimizer's
// chapter); that is asked how by bounce_of(). For all else the implicit step is perfectly inelastic. Where a
// contact closed in it at a speed u, impulses p ≥ 0 along
// the normals are added to the velocities that it left, so that the bodies part at e·u: projected
// Gauss–Seidel on
//     J M⁻¹ Jᵀ p ≥ e·u − J v,   p ≥ 0, complementary,
// M the trees' mass matrix over the unknowns. No step gains energy: p is scaled to what the impact took;
// against what is driven, which does work of its own (a bat, a lift), to what it took of their motion against
// that: ½ Σ p₀(u − Jv), p₀ the impulses that stopped it. Simultaneous impacts after Newton's hypothesis. What
// they press rubs as well: in the same sweeps two impulses along each surface, |p_t| ≤ μp, that leave no slip
// where they can. What the solve itself pressed has rubbed in it (end_velocities.h).
#pragma once

#include <span>
#include <vector>

#include "sinew/effects/island_effect.h"

namespace sinew {

/// Bounces of all contacts whose Contact::restitution is above 0; World::declare<Restitution>(). An impact
/// slower than 0.2 m/s (of a human; or than what gravity makes in two steps) stays inelastic.
template <class T>
class Restitution final : public IslandEffect<T> {
 public:
  using typename IslandEffect<T>::Trees;  ///< all that is solved together

  /// For 48 contacts that bounce after a solve.
  void reserve(const SolveCapacity& capacity) override;
  /// That reserve() takes.
  std::size_t bytes(const SolveCapacity& capacity) const override {
    return sizeof *this + capacity.path_entries * 7 * sizeof(T) +
           capacity.dofs * ((2 * kMostRows + 2) * sizeof(T) + 8 * sizeof(int)) +
           capacity.bodies * 2 * sizeof(Vec3<T>) + kMost * sizeof(Impact) +
           kMostRows * (kMostRows + 1) * sizeof(T);
  }

  /// Of what strikes before a solve, one after the other (island_landing.cpp).
  Bounce<T> bounce_of(const Contact<T>& contact, const Vec3<double>& gravity, T h) const override;
  /// Whether any contact both bounces and closed in this step, and has not bounced before the solve.
  bool may_change_speeds(std::span<const Contact<T>> contacts) const override;
  /// Costs three tree solves per bouncing contact.
  bool change_speeds(Trees trees, std::span<Contact<T>> contacts, const Vec3<double>& gravity, T h,
                     double budget) override;
  /// N·s along its normal that the last change_speeds() gave a contact; 0 if it did not bounce.
  T pushed(const Contact<T>& contact) const override;

 private:
  static constexpr int kMost = 48;             ///< contacts that bounce after a solve; more stay inelastic
  static constexpr int kMostRows = 3 * kMost;  ///< the normal of each, and two tangents

  void collect(Trees trees, std::span<Contact<T>> contacts, const Vec3<double>& gravity, T h);
  bool factorise(Trees trees);
  void project(Trees trees, const Contact<T>& contact, const Vec3<T>& direction, const Vec3<T>& at,
               std::span<T> row) const;
  T missing(std::size_t row, T wanted) const;
  void rub(std::size_t impact);
  void solve_impulses();
  bool meets_driven(Trees trees) const;
  double taken();
  void unload(Trees trees);
  T affordable(double allowed) const;
  void move(const IslandTree<T>& moved, int first);

  struct Impact {
    Contact<T>* contact = nullptr;
    T left = T(0);             ///< parting speed that the solve left, m/s
    T wanted = T(0);           ///< what is missing to the bounce's, m/s
    T slip[2] = {T(0), T(0)};  ///< along the contact's tangents, m/s
  };

  Unknowns unknowns_;
  PathAxes<T> axes_;
  TreeMatrix<T> mass_{unknowns_.pattern};
  std::vector<int> first_;  ///< [tree] where its part of the unknowns' map begins
  std::vector<Impact> impacts_;
  std::vector<T> impulse_;             ///< [row] N·s; three rows of each impact: normal, two tangents
  std::vector<T> rows_, answers_;      ///< [row][unknown] J and M⁻¹Jᵀ
  std::vector<T> delassus_;            ///< [row][row]
  std::vector<T> change_;              ///< [unknown] of its speed
  std::vector<Vec3<T>> turn_, slide_;  ///< [body]
};

extern template class Restitution<float>;
extern template class Restitution<double>;

}  // namespace sinew
