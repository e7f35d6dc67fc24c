// SinewCharacter, a script for a Skeleton below a SinewWorld: its bones are those of a character that follows
// a clip and is simulated where its muscles do not suffice.
#pragma once

#include <sinew/c/sinew.h>

#include <string>
#include <vector>

#include "axes.h"
#include "godot.h"

class SinewWorld;

class SinewCharacter {
 public:
  explicit SinewCharacter(godot::Object* self) : self_(self) {}
  ~SinewCharacter();
  SinewCharacter(const SinewCharacter&) = delete;
  SinewCharacter& operator=(const SinewCharacter&) = delete;
  static void register_with_godot();

  /// Before a step of h seconds: what the clip wants at its end becomes the target.
  bool aim(float h, double steps_per_second, const char* method);
  /// After it: moves the skeleton's bones, and tells when the character leaves its clip and is back on it.
  void show(const char* method);
  /// A touch that begins. `sign`: 1, or -1 where this character is the second of the two.
  void tell(const sinew_contact_event& contact, int sign);
  /// Its world is gone.
  void leave() { world_ = nullptr, character_ = 0; }

 private:
  /// A bone of the skeleton, and the joint that leads it.
  struct Bone {
    int parent = -1;
    int joint = -1;  // -1: rests on its parent
    axes::Rigid rest, from_joint;
  };

  godot::Value enter_tree(godot::Call&);
  godot::Value exit_tree(godot::Call&);
  godot::Value play(godot::Call& call);
  godot::Value push(godot::Call& call);
  godot::Value set_strength(godot::Call& call);
  godot::Value knock_down(godot::Call& call);
  godot::Value get_up(godot::Call& call);
  godot::Value is_on_animation(godot::Call&);
  godot::Value unknown_dofs(godot::Call&);
  godot::Value pose_hash(godot::Call& call);

  void set_asset_path(godot::Call& call);
  godot::Value asset_path() const { return asset_path_.c_str(); }
  void set_clip_name(godot::Call& call);
  godot::Value clip_name() const { return clip_name_.c_str(); }
  void set_speed(godot::Call& call);
  godot::Value speed() const { return speed_; }
  void set_balance(godot::Call& call);
  godot::Value balance() const { return balance_; }

  bool load(const char* method);
  bool join(const char* method);
  bool find_bones(const char* method);
  void make_bones();
  bool choose_clip(const std::string& name, const char* method);
  sinew_root_drive root() const { return balance_ ? SINEW_ROOT_GROUNDED : SINEW_ROOT_KINEMATIC; }
  bool lives(const char* method) const;
  int joint_of(godot::Call& call, int argument) const;
  sinew_view view(sinew_view_kind kind, const char* method) const;

  godot::Object* self_;
  SinewWorld* world_ = nullptr;
  sinew_asset asset_ = 0;
  sinew_character character_ = 0;
  std::string asset_path_, clip_name_;
  bool balance_ = false;

  int clip_ = 0;
  double speed_ = 1;
  double began_ = 0;      // clip time (s) after `steps_` = 0
  double steps_ = 0;      // since then
  double next_time_ = 0;  // of the clip, s: where it goes on if the speed changes
  bool fresh_ = true;     // to be put on its clip at once
  bool on_animation_ = true;
  bool rising_ = false;
  float strength_ = 1;  // of all muscles

  axes::Place place_;
  std::vector<sinew_jet> jets_;
  bool own_bones_ = false;          // made here: one for each joint, at rest without any rotation
  std::vector<Bone> bones_;         // parents first only as far as order_ says
  std::vector<int> order_;          // of bones_, parents first
  std::vector<int> bone_of_joint_;  // -1: none
  std::vector<axes::Rigid> posed_;  // of bones_, in the skeleton's space
};
