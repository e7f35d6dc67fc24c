// A world under observation: steps it and counts what its solver did. Energies, work, joints and depths come
// from the recorded poses (audit/), not from what the world reports of itself.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "scene/play.h"
#include "sinew/character/world.h"
#include "study/audit/books.h"
#include "study/schemes/schemes.h"

namespace sinew::study {

/// What a run showed. Energies in J, lengths in m.
struct Measurement {
  int steps = 0;
  bool finite = true;
  double kinetic_start = 0, kinetic_end = 0, kinetic_most = 0;
  double energy_gain = 0;      ///< least by which the total ever stood above start plus work (audit::Balance)
  double worst_rise = 0;       ///< least by which it rose beyond work within twelve steps
  double leap = 0;             ///< most by which a step's way must have needed more than there was
  double unsure = 0;           ///< most that the books cannot tell where they see well
  int instants = 0, seen = 0;  ///< judged by the books, and of these seen to 1e-3 of the kinetic energy
  int blind = 0;           ///< of the instants, those at which something turned too fast for poses to show
  double work = 0;         ///< put in by pushes, muscles and driven roots
  double joint_gap = 0;    ///< between the two halves of any joint
  double joint_angle = 0;  ///< rad, that a joint turned about what it is no hinge for
  double penetration = 0;  ///< deepest that two shapes lay in each other
  int unconverged = 0;     ///< steps of characters and props that moved in a solve, see `solved`
  int solved = 0;
  int restarts = 0;  ///< see CharacterReport
  long passes = 0, simplified_steps = 0, factorisations = 0;
  int most_passes = 0, most_factorisations = 0;  ///< of one solve: a step in parts on purpose is so many
  std::array<int, 256> pass_histogram{};         ///< solved steps by passes of a solve (the last: or more)
  double microseconds = 0;                       ///< processor time of all steps together
  std::vector<float> solved_us;  ///< of each step in which something was solved, but for the first three
  std::string refused;           ///< reason of the step that the world refused, or empty

  double mean_passes() const { return solved ? double(passes) / solved : 0; }
  double mean_iterations() const { return solved ? double(passes + simplified_steps) / solved : 0; }
  double mean_factorisations() const { return solved ? double(factorisations) / solved : 0; }
  double seen_share() const { return instants ? double(seen) / instants : 0; }
  double unconverged_share() const { return solved ? double(unconverged) / solved : 0; }
  int passes_percentile(double share) const;
  /// The slowest of the steps in which something was solved, over their median; 0: there are none.
  double slowest_over_median() const;
  /// Counts one solved step of a character or prop.
  void count(const CharacterReport& report);
  void merge(const Measurement& other);  ///< sums of counts, worst of the rest
};

template <class T>
class Stage {
 public:
  explicit Stage(const WorldSettings& settings, Compared scheme = Compared::kBossak);
  /// Plays a scene, of which it keeps a copy: sets it up, and does in every step what the scene asks for.
  explicit Stage(const scene::Scene& scene, Compared scheme = Compared::kBossak);

  /// Adds a character that starts in the state of `jets` (its rest pose where empty) and keeps it as target.
  /// Returns its index; a refusal ends the run (`measured().refused`).
  int add(const Skeleton& skeleton, const CharacterSettings& settings,
          const std::vector<JointJet<T>>& jets = {});
  int add_prop(const PropSettings& settings);
  void add_obstacle(const Collider& obstacle);

  /// Impulse (N·s) at a world point of a joint at the beginning of the next step; its work is booked.
  void push(int character, int joint, const Vec3<double>& point, const Vec3<double>& impulse) {
    push({character, joint, point, impulse, false}, 1);
  }
  /// A force (N) over the next step, of h seconds.
  void press(int character, int joint, const Vec3<double>& point, const Vec3<double>& force, double h) {
    push({character, joint, point, h * force, true}, h);
  }
  /// The state has been set from outside (teleport, reset): the books start afresh at the next step.
  void forget() { books_.forget(); }

  /// Counts passes, factorisations and unconverged steps only where something touches.
  void count_in_contact_only() { in_contact_only_ = true; }

  /// Ends the run: something could not be set up.
  void refuse(const std::string& reason) { m_.refused = reason; }

  bool step(double h);
  /// Steps for `seconds`, calling before(t) ahead of each step.
  template <class Before>
  void run(double seconds, double h, Before before) {
    const int count = static_cast<int>(std::lround(seconds / h));
    for (int n = 0; n < count; ++n) {
      before(n * h);
      if (!step(h)) return;
    }
  }
  void run(double seconds, double h) {
    run(seconds, h, [](double) {});
  }

  World<T>& world() { return *world_; }
  Character<T> character(int index) { return world_->character(index); }
  const Measurement& measured() const { return m_; }
  const WorldSettings& settings() const { return settings_; }
  Vec3<double> center_of_mass(int character);
  double kinetic() const { return books_.kinetic(); }  ///< J, over the last step
  const audit::Books& books() const { return books_; }
  const audit::Surroundings& surroundings() const { return around_; }
  /// m, deepest that shapes lie in each other now: all, or one character (or prop: after the characters) in
  /// anything else.
  double depth() const;
  double depth(int member) const;
  /// m, how far the ends of a loop of the scene are apart now.
  double loop_gap(int loop) const;

 private:
  struct Push {
    int character, joint;
    Vec3<double> local, before, impulse;  ///< the point in its joint's axes and in the world, before the step
    audit::Estimate speed;                ///< its, before it
    bool strikes;                         ///< acts at once; else over the step
  };
  struct Script {
    Script(const scene::Scene& of, World<T>& world) : scene(of), play(scene, world) {}
    scene::Scene scene;
    scene::Play<T> play;
    double time = 0;  ///< s
  };

  void enter(const Skeleton& skeleton, const std::vector<JointJet<T>>& start, const CharacterSettings& as);
  void enter(const PropSettings& prop);
  bool follow_script(double h);

  void push(const scene::Impulse& push, double h);
  double work_of_loads(double h) const;
  double work_of_strikes(int character, double& unsure) const;
  double work_of_muscles(const std::vector<Transform<double>>& poses) const;
  bool root_is_driven(int character) const;
  int body_of(int character, int joint) const;
  std::vector<Transform<double>> poses() const;
  audit::Poses poses_of(int member) const { return books_.poses(member); }
  void look();
  void balance();
  void count(const CharacterReport& report);

  WorldSettings settings_;
  bool strikes_;  ///< impulses act at once, as they do in the runtime's own scheme
  std::unique_ptr<World<T>> world_;
  std::unique_ptr<Script> script_;
  std::vector<RootDrive> roots_;  ///< [character] without a scene's timeline
  std::vector<Push> pushes_;
  audit::Books books_;
  audit::Surroundings around_;
  Measurement m_;
  bool in_contact_only_ = false;
};

/// Kinetic and potential energy (J) of a skeleton in the state of `jets`.
struct Energy {
  double kinetic = 0, potential = 0;
};
template <class T>
Energy energy_of(const Skeleton& skeleton, const std::vector<JointJet<T>>& jets, const Vec3<double>& gravity);

/// The rest pose at rest.
template <class T>
std::vector<JointJet<T>> rest_jets(const Skeleton& skeleton);

extern template class Stage<float>;
extern template class Stage<double>;

}  // namespace sinew::study
