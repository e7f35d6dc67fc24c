// Which features may touch within a step: floor, static obstacles, other trees, and a character itself.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sinew/character/closeness.h"
#include "sinew/character/internal_edge.h"
#include "sinew/character/neighbour_grid.h"
#include "sinew/character/return_to_animation.h"
#include "sinew/character/state.h"
#include "sinew/character/touching.h"
#include "sinew/effects/crossing_edges.h"
#include "sinew/effects/static_shape.h"

namespace sinew {

/// What a loaded contact hands on to the next step: its normal force, for friction, and how stiff it was.
template <class T>
struct LaggedForce {
  std::uint64_t id = 0;
  T force = T(0);                   ///< N
  T stiffness = T(0);               ///< N/m
  T offset = T(0);                  ///< m, see Contact::offset
  T smooth = T(0);                  ///< N, see Contact::smooth_before
  T lasting = T(0), before = T(0);  ///< N, see Contact::lasting_last
  std::array<T, 2> elastic{};       ///< see elastic_share()
};

/// Identities of the contacts of a world's nth tree begin here and end where the next one's begin.
constexpr std::uint64_t first_contact_id(int n) {
  return std::uint64_t(n + 1) << 48;
}
/// The number of the second tree of a contact; −1: the static world.
constexpr int other_tree(std::uint64_t id) {
  return static_cast<int>((id >> 16) & 0xffff) - 1;
}
/// Whether a contact is of a tree, as either side.
constexpr bool is_of_tree(std::uint64_t id, int tree) {
  return id >> 48 == first_contact_id(tree) >> 48 || other_tree(id) == tree;
}
constexpr int kMostTrees = 0xfffe;  ///< that identities have room for
constexpr int kFirstHost = 0x4000;  ///< their numbers of the host's shapes begin here, obstacles' at 0

constexpr double kLeftInside = 1e-3;  ///< m, that depenetration leaves
/// Which point of which tree a contact is of.
template <class T>
std::uint64_t point_of(const Contact<T>& c) {
  return c.id >> 32;
}

constexpr double kImpactSpeed = 0.2;  ///< m/s of a human; what closes more slowly is no impact
/// Whether a contact that bears nothing yet is about to strike within h seconds, at the speed that it has.
template <class T>
bool strikes_within(const Contact<T>& c, T h) {
  return c.fresh && c.approach > T(kImpactSpeed) * c.speed_scale && c.start_gap < h * c.approach;
}

/// A shape of the host's, and what it is made of.
struct HostObstacle {
  const StaticShape* shape = nullptr;
  double friction = 0.8, restitution = 0;
};

/// Two bodies, by their trees' numbers in the world; body −1: every body of the tree.
struct BodyPair {
  int state_a = 0, body_a = -1;
  int state_b = 0, body_b = -1;
};

/// What stands around, apart from the floor, and who never touches whom.
struct Surroundings {
  std::span<const Collider> obstacles;
  const NeighbourGrid* grid = nullptr;  ///< of the obstacles' bounding spheres
  std::span<const HostObstacle> hosts;
  std::span<const BodyPair> apart;
  double floor = -std::numeric_limits<double>::infinity();  ///< m, its height in the world
};

template <class T>
class ContactSearch {
 public:
  virtual ~ContactSearch() = default;
  /// For so much, among so many obstacles.
  virtual void reserve(const SolveCapacity& capacity, int obstacles) = 0;
  /// That reserve() takes.
  virtual std::size_t bytes(const SolveCapacity& capacity) const = 0;

  /// All pairs that may touch within h seconds, measured at the kinematics that the states hold (about
  /// `common_origin`). `indices` are the trees' numbers in the world, for identities that last; `lagged` is
  /// sorted by id. Features that no unknown moves do not meet the floor: a driven root bears what its feet
  /// would. Nor do they meet each other, where they are of one tree, or no muscles of either may be overcome.
  /// What follows a clip begins to bear where the clip presses it, in the floor at any depth where its root
  /// is kinematic, elsewhere as kPressedByClips says. Allocates nothing; where the trees' room does not do,
  /// those between trees that are furthest apart are left out, and only if that does not do, such of static
  /// obstacles: see left_out().
  virtual std::span<Contact<T>> find(const WorldSettings& world, const Surroundings& surroundings,
                                     std::span<CharacterState<T>* const> states, std::span<const int> indices,
                                     std::span<const LaggedForce<T>> lagged,
                                     const Vec3<double>& common_origin, T h) = 0;
  /// How many candidates the last find() had no room for.
  virtual int left_out() const = 0;
};

template <class T>
class ContactFinder final : public ContactSearch<T> {
 public:
  void reserve(const SolveCapacity& capacity, int obstacles) override;
  std::size_t bytes(const SolveCapacity& capacity) const override {
    return capacity.contacts * (sizeof(Contact<T>) + sizeof(T)) + capacity.colliders * sizeof(Bound) +
           capacity.bodies;
  }
  std::span<Contact<T>> find(const WorldSettings& world, const Surroundings& surroundings,
                             std::span<CharacterState<T>* const> states, std::span<const int> indices,
                             std::span<const LaggedForce<T>> lagged, const Vec3<double>& common_origin,
                             T h) override;
  int left_out() const override { return left_out_; }

 private:
  /// Bounding sphere of a collider now, and how far its body may come within the step.
  struct Bound {
    Vec3<T> center;
    T radius = T(0), reach = T(0);
    bool moved = false;  ///< by some unknown, or on the return to its animation
  };

  /// How a body follows a clip.
  enum class Follows : std::uint8_t {
    kNot,
    kRoughly,  ///< its joints are driven, but some unknown moves it
    kExactly,  ///< or is on its return
  };

  void bound(const CharacterState<T>& state, T h);
  void find_followers(CharacterState<T>& state);
  PlacedCollider<T> collider_at(int n, std::size_t collider, const Kinematics<T>& kinematics) const;
  bool driven_through(int n, const Collider& obstacle) const;
  bool driven_through(int n, int m) const;
  T pressed_at_most(const Contact<T>& contact) const;
  void allow_pressed(Contact<T>& contact) const;
  /// About the common origin.
  Transform<T> pose_of(const Collider& obstacle) const {
    return {obstacle.local.rotation.template cast<T>(),
            (obstacle.local.translation - common_origin_).template cast<T>()};
  }
  void find_near(int n, const Surroundings& surroundings);
  void meet_static(int n, const Surroundings& surroundings);
  void meet_hosts(int n, int collider, std::span<const HostObstacle> hosts);
  void meet_tree(int n, int m);
  bool kept_apart(int n, int body, int m, int other) const;
  void meet_collider(int n, int collider, int m, int other);
  /// What a collider meets: another's collider, or an obstacle.
  struct Met {
    Shape shape = Shape::kSphere;
    Vec3<T> size = Vec3<T>::Zero();    ///< as Collider::size
    const ConvexHull* hull = nullptr;  ///< of who is convex
    Transform<T> local;                ///< shape → its body, or → the common origin
    T friction = T(0), restitution = T(0);
    int tree = -1, body = -1;  ///< of the solve; −1: static
    int number = 0;            ///< of identities: of the collider or obstacle
    bool second = false;       ///< the same pair meets the other way round, too, and did before
  };
  /// What a contact with the thing met needs beside what meets.
  Contact<T> contact_with(const Met& met, Contact<T> own, T friction) const;
  std::uint64_t id_of(int n, int point, const Met& met) const;
  Transform<T> pose_of(const Met& met) const;
  void meet(int n, int collider, Met met, T reach);
  void meet_points(int n, int collider, const Met& met, int face, T reach);
  bool lie_along(int n, int collider, const Met& met) const;
  PlacedShape<T> placed(int n, int collider) const;
  PlacedShape<T> placed(const Met& met, T unit) const;
  void meet_edges(int n, int collider, const Met& met, T reach);
  void meet_solids(int n, int collider, const Met& met, T reach);
  bool crushes(int n, int m) const;
  void leave_to_others(Contact<T>& solids) const;
  void meet_corners(int n, int collider, const Met& met, T reach);
  void let_roll(Contact<T>& contact) const;
  void add(Contact<T>& contact, T reach);
  bool reserve();
  int way_out(int n, int collider, const Vec3<T>& size, const Transform<T>& pose) const;
  int way_in(int n, int collider, const Met& met) const;
  int way_out_of_hull(int n, int collider, const Met& met) const;
  void go_on_below(T unit, const Vec3<T>& other, Met& box) const;
  void begin_all();
  void remember(Contact<T>& contact) const;
  void depenetrate(Contact<T>& contact) const;
  bool may_soften(const Contact<T>& contact) const;
  T soften(Contact<T>& contact, T back, T most) const;
  T parting_speed(const Contact<T>& contact) const;
  bool give_way(Contact<T>& contact) const;
  void count_depenetrating();
  bool is_internal(const Contact<T>& contact) const;
  void stiffen_for_impact(Contact<T>& contact) const;
  Contact<T> contact_of(int n, const ContactPoint<T>& point) const;
  Contact<T> contact_of(int n, const Collider& collider) const;

  const WorldSettings* world_ = nullptr;
  std::span<CharacterState<T>* const> states_;
  std::span<const int> indices_;
  std::span<const LaggedForce<T>> lagged_;
  std::span<const BodyPair> apart_;
  Vec3<double> common_origin_ = Vec3<double>::Zero();
  T h_ = T(0), bears_ = T(0);  ///< s; kg
  T damping_time_ = T(0);      ///< of a human's contacts, s
  T impact_depth_ = T(0);      ///< m, in which what strikes is stopped, of a human
  T most_sunk_ =
      T(0);  ///< m of a human: a normal force that sinks a contact deeper adds nothing to its friction
  std::vector<Contact<T>> contacts_;
  std::size_t capacity_ = 0, most_ = 0;  ///< contacts that there is memory for, and that these trees may have
  std::vector<T> gaps_;                  ///< m, for reserve()
  T most_gap_[2] = {T(0), T(0)};  ///< m, of static contacts and of those between trees that there is room for
  int left_out_ = 0;
  CrossingEdges<T> edges_;          ///< of a pair of colliders
  std::vector<Bound> bounds_;       ///< all colliders of all states
  std::vector<int> first_bound_;    ///< [state]
  std::vector<Follows> follows_;    ///< [body, trees one after the other] see find_followers
  std::vector<int> first_body_;     ///< [state] in these
  std::vector<int> near_;           ///< obstacles that the present state may touch, ascending
  std::vector<int> depenetrating_;  ///< [state] contacts through which it is brought out of something
};

/// Half the thickness of an obstacle, m: of a box that stands on a floor (m, its height), on below which it
/// goes, only across. `unit`: Scale::length.
double half_thickness_of(const Collider& obstacle, double floor, double unit);

template <class T>
struct Nearby;
template <class T>
struct Members;
struct BearingGround;
template <class T>
struct BearingPoint;

/// What a world's step asks of contacts.
template <class T>
struct ContactTerm {
  std::unique_ptr<ContactSearch<T>> (*make_finder)();
  // See nearby.h.
  void (*look_around)(CharacterState<T>& state, const WorldSettings& world, const Surroundings& around,
                      const Members<T>& members, T h, Nearby<T>& out);
  bool (*is_in_the_way)(CharacterState<T>& state, Nearby<T>& nearby);
  const GroundProbe<T>* (*ground_under)(CharacterState<T>& state, Nearby<T>& nearby);
  void (*load_props)(const Nearby<T>& nearby, std::span<const BearingPoint<T>> bearing);
  BearingGround (*ground_that_moves)(const Nearby<T>& nearby, std::span<const StandingPoint<T>> standing);
  void (*append_moving)(CharacterState<T>& state, T h, std::vector<MovingCollider<T>>& out);
  bool (*come_close)(std::span<const MovingCollider<T>> a, std::span<const MovingCollider<T>> b, T h,
                     T margin);
  Eigen::AlignedBox<T, 3> (*swept_box)(CharacterState<T>& state, T h);
  bool (*boxes_come_close)(const Eigen::AlignedBox<T, 3>& a, const Eigen::AlignedBox<T, 3>& b, T h, T margin);
  // See touching.h.
  void (*place_colliders)(CharacterState<T>& state, std::span<const Transform<T>> pose,
                          const Vec3<double>& root, const Vec3<double>& origin,
                          std::vector<PlacedCollider<T>>& out);
  void (*predict_colliders)(CharacterState<T>& state, std::span<const PlacedCollider<T>> from,
                            const Vec3<double>& origin, const Vec3<T>& gravity, T h,
                            std::vector<PlacedCollider<T>>& out);
  bool (*touch_on_the_way)(const ColliderPaths<T>& a, const ColliderPaths<T>& b, T depth);
  // See contact.h.
  void (*append_points)(const Collider& collider, std::vector<ContactPoint<T>>& out, int index, double unit);
  void (*share_stiffness)(std::vector<ContactPoint<T>>& points);
  void (*measure)(const Kinematics<T>& a, const Kinematics<T>* b, Contact<T>& contact);
  // See internal_edge.h.
  bool (*is_internal_edge)(const Contact<T>& edge, std::span<const Contact<T>> contacts, T tolerance,
                           std::span<CharacterState<T>* const> states);
};

extern template class ContactFinder<float>;
extern template class ContactFinder<double>;

}  // namespace sinew
