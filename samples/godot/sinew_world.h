// SinewWorld, a script for a Spatial: a world of Sinew's, in the node's own space, and the steps that it
// takes.
#pragma once

#include <sinew/c/sinew.h>

#include <vector>

#include "godot.h"

class SinewCharacter;

/// Tells Godot's error print what the last call of Sinew was refused for. True if it was not.
bool done(sinew_status status, const char* method, const std::string& what);

class SinewWorld {
 public:
  explicit SinewWorld(godot::Object* self);
  ~SinewWorld();
  SinewWorld(const SinewWorld&) = delete;
  SinewWorld& operator=(const SinewWorld&) = delete;
  static void register_with_godot();

  /// The nearest one above a node; null if there is none.
  static SinewWorld* above(godot::Object* node);
  godot::Object* self() const { return self_; }
  sinew_world handle() const { return world_; }
  /// In the order in which Sinew was given them.
  void add(SinewCharacter* character) { characters_.push_back(character); }
  void remove(SinewCharacter* character);

 private:
  godot::Value enter_tree(godot::Call&);
  godot::Value physics_process(godot::Call& call);
  godot::Value step(godot::Call&);
  godot::Value throw_ball(godot::Call& call);
  godot::Value move_ball(godot::Call& call);
  godot::Value ball_transform(godot::Call& call);
  void set_rate(godot::Call& call);
  godot::Value rate() const { return steps_per_second_; }
  void set_running(godot::Call& call);
  godot::Value running() const { return running_; }
  void advance(const char* method);
  void tell_contacts(const char* method);
  sinew_prop ball(godot::Call& call) const;

  godot::Object* self_;
  sinew_world world_ = 0;
  std::vector<SinewCharacter*> characters_;  // null where one is gone
  std::int64_t balls_ = 0;
  double steps_per_second_ = 60;
  double pending_ = 0;  // s, not stepped yet
  bool running_ = true;
};
