// Restitution: what a solve took out of an impact is given back in part, as velocities.
//
// The implicit step is perfectly inelastic. Where a contact closed in it at a speed u, impulses p ≥ 0 along
// the normals are added to the velocities that it left, so that the bodies part at e·u: projected
// Gauss–Seidel on
//     J M⁻¹ Jᵀ p ≥ e·u − J v,   p ≥ 0, complementary,
// M the trees' mass matrix over the unknowns. No step gains energy: p is scaled to what the impact took.
// Simultaneous impacts after Newton's hypothesis; friction does not bounce.
#pragma once

#include <span>
#include <vector>

#include "sinew/character/state.h"

namespace sinew {

template <class T>
class Bounce {
 public:
  void reserve(const SolveRoom& room);
  /// That reserve() takes.
  static std::size_t bytes(const SolveRoom& room) {
    return room.path_entries * 7 * sizeof(T) + room.dofs * ((2 * kMost + 2) * sizeof(T) + 8 * sizeof(int)) +
           room.bodies * 2 * sizeof(Vec3<T>) + kMost * (sizeof(Impact) + kMost * sizeof(T));
  }

  /// Whether any contact both bounces and closed in this step.
  static bool possible(std::span<const Contact<T>> contacts);
  /// Changes the velocities of the trees' histories where contacts closed in the step of h seconds that led
  /// to the problems' kinematics. `budget` is the energy before that step. True if anything bounced. Costs
  /// one tree solve per bouncing contact.
  bool apply(std::span<CharacterState<T>* const> states, std::span<Contact<T>> contacts,
             const Vec3<double>& gravity, T h, double budget);

 private:
  static constexpr int kMost = 48;  ///< bouncing contacts of one step; more stay inelastic

  void collect(std::span<CharacterState<T>* const> states, std::span<Contact<T>> contacts,
               const Vec3<double>& gravity, T h);
  bool factorise(std::span<CharacterState<T>* const> states);
  void project(std::span<CharacterState<T>* const> states, const Contact<T>& contact, std::span<T> row) const;
  void solve_impulses();
  void unload(std::span<CharacterState<T>* const> states);
  T affordable(double allowed) const;
  void move(CharacterState<T>& state, int first);

  struct Impact {
    Contact<T>* contact = nullptr;
    T left = T(0);     ///< parting speed that the solve left, m/s
    T wanted = T(0);   ///< what is missing to the bounce's, m/s
    T impulse = T(0);  ///< N·s
  };

  Unknowns unknowns_;
  PathAxes<T> axes_;
  TreeMatrix<T> mass_{unknowns_.pattern};
  std::vector<int> first_;  ///< [tree] where its part of the unknowns' map begins
  std::vector<Impact> impacts_;
  std::vector<T> rows_, answers_;      ///< [impact][unknown] J and M⁻¹Jᵀ
  std::vector<T> delassus_;            ///< [impact][impact]
  std::vector<T> change_;              ///< [unknown] of its speed
  std::vector<Vec3<T>> turn_, slide_;  ///< [body]
};

extern template class Bounce<float>;
extern template class Bounce<double>;

}  // namespace sinew
