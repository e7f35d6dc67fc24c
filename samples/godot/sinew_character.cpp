#include "sinew_character.h"

#include <utility>

#include "sinew_world.h"

using axes::Rigid;
using axes::Transform;
using gdnative::kInt;
using gdnative::kString;
using gdnative::kVector3;
using godot::Call;
using godot::Object;
using godot::Value;

namespace {

const char* name_of(sinew_body_kind kind) {
  switch (kind) {
    case SINEW_BODY_GROUND:
      return "ground";
    case SINEW_BODY_OBSTACLE:
      return "obstacle";
    case SINEW_BODY_SHAPE:
      return "shape";
    case SINEW_BODY_CHARACTER:
      return "character";
    case SINEW_BODY_PROP:
      return "prop";
    default:
      return "particles";
  }
}

const sinew_transform& joint_in(const sinew_view& view, int joint) {
  return *reinterpret_cast<const sinew_transform*>(static_cast<const char*>(view.data) + joint * view.stride);
}

std::int64_t count_of_bones(Object* skeleton) {
  static godot::Method get_bone_count{"Skeleton", "get_bone_count"};
  std::int64_t count = 0;
  get_bone_count.call(skeleton, {}, &count);
  return count;
}

void set_pose(Object* skeleton, std::size_t bone, const Transform& pose) {
  static godot::Method set_bone_pose{"Skeleton", "set_bone_pose"};
  const std::int64_t index = std::int64_t(bone);
  set_bone_pose.call(skeleton, {&index, &pose});
}

}  // namespace

void SinewCharacter::register_with_godot() {
  godot::Class<SinewCharacter>("SinewCharacter", "Skeleton")
      .method<&SinewCharacter::enter_tree>("_enter_tree")
      .method<&SinewCharacter::exit_tree>("_exit_tree")
      .method<&SinewCharacter::play>("play")
      .method<&SinewCharacter::push>("push")
      .method<&SinewCharacter::set_strength>("set_strength")
      .method<&SinewCharacter::knock_down>("knock_down")
      .method<&SinewCharacter::get_up>("get_up")
      .method<&SinewCharacter::is_on_animation>("is_on_animation")
      .method<&SinewCharacter::unknown_dofs>("unknown_dofs")
      .method<&SinewCharacter::pose_hash>("pose_hash")
      .property<&SinewCharacter::set_asset_path, &SinewCharacter::asset_path>("asset", "")
      .property<&SinewCharacter::set_clip_name, &SinewCharacter::clip_name>("clip", "")
      .property<&SinewCharacter::set_speed, &SinewCharacter::speed>("speed", 1.0)
      .property<&SinewCharacter::set_balance, &SinewCharacter::balance>("balance", false);
  godot::register_signal("SinewCharacter", "contact_began",
                         {{"bone", kInt}, {"with", kString}, {"position", kVector3}, {"impulse", kVector3}});
  godot::register_signal("SinewCharacter", "left_animation", {});
  godot::register_signal("SinewCharacter", "returned_to_animation", {});
}

SinewCharacter::~SinewCharacter() {
  if (world_) world_->remove(this);
  if (world_ && character_) sinew_character_park(character_, 1);
  if (asset_) sinew_asset_destroy(asset_);
}

// ---- Into the world ----

Value SinewCharacter::enter_tree(Call& call) {
  if (character_) {  // it was here before
    if (SinewWorld::above(self_) != world_)
      godot::error(call.method, asset_path_ + ": a character stays in the SinewWorld that it was in first");
    else
      done(sinew_character_park(character_, 0), call.method, asset_path_);
    return {};
  }
  world_ = SinewWorld::above(self_);
  if (!world_) {
    godot::error(call.method, "a SinewCharacter belongs below a SinewWorld");
    return {};
  }
  if (load(call.method) && join(call.method)) return {};
  if (character_) {
    sinew_character_park(character_, 1);
    world_->remove(this);
  }
  leave();
  return {};
}

Value SinewCharacter::exit_tree(Call& call) {
  if (character_) done(sinew_character_park(character_, 1), call.method, asset_path_);
  return {};
}

bool SinewCharacter::load(const char* method) {
  if (asset_) sinew_asset_destroy(std::exchange(asset_, 0));  // of an attempt before
  const auto bytes = godot::read_file(asset_path_, method);
  return bytes && done(sinew_asset_read(bytes->data(), bytes->size(), &asset_), method, asset_path_) &&
         choose_clip(clip_name_, method);
}

bool SinewCharacter::join(const char* method) {
  sinew_asset_info info{};
  info.size = sizeof info;
  sinew_character_settings settings{};
  settings.size = sizeof settings;
  if (!done(sinew_asset_get_info(asset_, &info), method, asset_path_) ||
      !done(sinew_character_settings_init(&settings), method, asset_path_))
    return false;
  settings.root = root();
  sinew_character joined = 0;
  if (!done(sinew_world_add_character(world_->handle(), asset_, &settings, &joined), method, asset_path_))
    return false;
  world_->add(this);
  character_ = joined;
  if (balance_ && !done(sinew_character_add_behaviour(character_, nullptr), method, asset_path_))
    return false;
  jets_.resize(std::size_t(info.joints));
  place_ = axes::Place(Rigid(godot::global_transform_of(world_->self())).inverse() *
                       Rigid(godot::global_transform_of(self_)));
  return find_bones(method);
}

// ---- Bones ----

void SinewCharacter::make_bones() {
  static godot::Method add_bone{"Skeleton", "add_bone"}, set_bone_parent{"Skeleton", "set_bone_parent"};
  for (std::size_t j = 0; j < jets_.size(); ++j) {
    sinew_joint_info joint{};
    joint.size = sizeof joint;
    sinew_asset_get_joint(asset_, std::int32_t(j), &joint);
    const godot::Words name(joint.name);
    const std::int64_t bone = std::int64_t(j), parent = joint.parent;
    add_bone.call(self_, {&name.raw});
    set_bone_parent.call(self_, {&bone, &parent});
  }
}

bool SinewCharacter::find_bones(const char* method) {
  static godot::Method find_bone{"Skeleton", "find_bone"}, get_bone_parent{"Skeleton", "get_bone_parent"},
      get_bone_rest{"Skeleton", "get_bone_rest"};
  own_bones_ = count_of_bones(self_) == 0;
  if (own_bones_) make_bones();
  const auto count = std::size_t(count_of_bones(self_));
  bones_.assign(count, {});
  posed_.assign(count, {});
  bone_of_joint_.assign(jets_.size(), -1);
  for (std::size_t b = 0; b < count; ++b) {
    const std::int64_t bone = std::int64_t(b);
    std::int64_t parent = -1;
    Transform rest{1, 0, 0, 0, 1, 0, 0, 0, 1};
    get_bone_parent.call(self_, {&bone}, &parent);
    get_bone_rest.call(self_, {&bone}, &rest);
    bones_[b].parent = int(parent);
    bones_[b].rest = Rigid(rest);
  }
  order_.clear();
  std::vector<bool> ordered(count, false);
  for (std::size_t before = count + 1; order_.size() != before;) {  // parents may stand behind their children
    before = order_.size();
    for (std::size_t b = 0; b < count; ++b) {
      const int parent = bones_[b].parent;
      if (ordered[b] || (parent >= 0 && !ordered[std::size_t(parent)])) continue;
      order_.push_back(int(b));
      ordered[b] = true;
    }
  }
  const sinew_view rest = view(SINEW_VIEW_MODEL, method);
  if (rest.count == 0) return false;
  bool any = false;
  for (std::size_t j = 0; j < jets_.size(); ++j) {
    sinew_joint_info joint{};
    joint.size = sizeof joint;
    sinew_asset_get_joint(asset_, std::int32_t(j), &joint);
    std::int64_t bone = -1;
    const godot::Words name(joint.name);
    find_bone.call(self_, {&name.raw}, &bone);
    if (bone < 0) continue;
    any = true;
    bone_of_joint_[j] = int(bone);
    bones_[std::size_t(bone)].joint = int(j);
  }
  if (!any)
    godot::error(method, asset_path_ + ": no bone of this Skeleton has the name of a joint of the asset");
  // Joints and bones of a name are turned against each other once and for all: how, shows at rest.
  for (const int b : order_) {
    Bone& bone = bones_[std::size_t(b)];
    Rigid& at_rest = posed_[std::size_t(b)];
    at_rest = bone.parent < 0 ? bone.rest : posed_[std::size_t(bone.parent)] * bone.rest;
    if (bone.joint >= 0)
      bone.from_joint = Rigid(axes::to_godot(joint_in(rest, bone.joint))).inverse() * at_rest;
  }
  return any;
}

void SinewCharacter::show(const char* method) {
  if (!character_) return;
  const sinew_view model = view(SINEW_VIEW_MODEL, method);
  if (model.count == 0) return;
  const Rigid to_skeleton = place_.rigid().inverse();
  if (own_bones_) {  // its bones are the joints: the same floats
    const sinew_view local = view(SINEW_VIEW_LOCAL, method);
    for (std::size_t j = 0; j < std::size_t(local.count); ++j) {
      Transform pose = axes::to_godot(joint_in(local, int(j)));
      if (bones_[j].parent < 0 && !place_.is_none()) pose = Transform(to_skeleton * Rigid(pose));
      set_pose(self_, j, pose);
    }
  } else {
    for (const int b : order_) {
      const Bone& bone = bones_[std::size_t(b)];
      const Rigid parent = bone.parent < 0 ? Rigid() : posed_[std::size_t(bone.parent)];
      const Rigid resting = parent * bone.rest;
      Rigid& posed = posed_[std::size_t(b)];
      posed = bone.joint < 0
                  ? resting
                  : to_skeleton * Rigid(axes::to_godot(joint_in(model, bone.joint))) * bone.from_joint;
      set_pose(self_, std::size_t(b), Transform(resting.inverse() * posed));
    }
  }
  sinew_character_report report{};
  report.size = sizeof report;
  if (!done(sinew_character_get_report(character_, &report), method, asset_path_)) return;
  const bool was_on = on_animation_;
  on_animation_ = report.on_animation != 0;
  if (rising_ && on_animation_) {
    rising_ = false;
    done(sinew_character_set_root_drive(character_, root()), method, asset_path_);
  }
  if (was_on != on_animation_) godot::emit(self_, was_on ? "left_animation" : "returned_to_animation", {});
}

void SinewCharacter::tell(const sinew_contact_event& contact, int sign) {
  const int joint = sign > 0 ? contact.a.joint : contact.b.joint;
  const sinew_body& other = sign > 0 ? contact.b : contact.a;
  double impulse[3];
  for (int k = 0; k < 3; ++k) impulse[k] = sign * contact.impulse * contact.normal[k];
  const Value bone(bone_of_joint_[std::size_t(joint)]), with(name_of(other.kind)),
      at(axes::to_godot(contact.point[0].position)), by(axes::to_godot(impulse));
  godot::emit(self_, "contact_began", {&bone, &with, &at, &by});
}

// ---- Clips ----

bool SinewCharacter::choose_clip(const std::string& name, const char* method) {
  std::int32_t found = 0;
  if (!name.empty() && !done(sinew_asset_find_clip(asset_, name.c_str(), &found), method, name)) return false;
  clip_ = found;
  return true;
}

Value SinewCharacter::play(Call& call) {
  if (!lives(call.method)) return {};
  if (call.is(0, kInt)) {
    const auto index = std::int32_t(call.whole(0, "clip"));
    sinew_clip_info info{};
    info.size = sizeof info;
    if (!done(sinew_asset_get_clip(asset_, index, &info), call.method, "clip " + std::to_string(index)))
      return {};
    clip_ = index;
    clip_name_ = info.name;
  } else {
    const std::string name = call.words(0, "clip");
    if (!call.good || !choose_clip(name, call.method)) return {};
    clip_name_ = name;
  }
  began_ = steps_ = next_time_ = 0;
  fresh_ = true;
  return {};
}

bool SinewCharacter::aim(float h, double steps_per_second, const char* method) {
  if (!character_) return true;
  const double time = began_ + steps_ * speed_ / steps_per_second;
  ++steps_;
  next_time_ = began_ + steps_ * speed_ / steps_per_second;
  const auto count = std::int32_t(jets_.size());
  const std::string& what = asset_path_;
  if (!done(sinew_clip_sample(asset_, clip_, time, speed_, 0, jets_.data(), count), method, what))
    return false;
  if (!place_.is_none()) place_.put(jets_[0]);
  const bool set = balance_ && !fresh_ && !rising_
                       ? done(sinew_character_balance(character_, jets_.data(), count, h), method, what)
                       : done(sinew_character_set_target(character_, jets_.data(), count), method, what);
  if (!set || !fresh_) return set;
  fresh_ = false;
  return done(sinew_character_reset(character_), method, what);
}

// ---- What happens to it ----

Value SinewCharacter::push(Call& call) {
  if (!lives(call.method)) return {};
  const int joint = joint_of(call, 0);
  const auto impulse = axes::to_sinew(call.vector(1, "impulse"));
  if (joint < 0 || !call.good) return {};
  const sinew_transform& at = joint_in(view(SINEW_VIEW_MODEL, call.method), joint);
  std::array<double, 3> point{at.translation[0], at.translation[1], at.translation[2]};
  if (call.has(2)) point = axes::to_sinew(call.vector(2, "at"));
  if (call.good)
    done(sinew_character_apply_impulse(character_, joint, point.data(), impulse.data()), call.method,
         "the impulse");
  return {};
}

Value SinewCharacter::set_strength(Call& call) {
  if (!lives(call.method)) return {};
  const auto strength = float(call.real(0, "strength"));
  const int joint = call.has(1) ? joint_of(call, 1) : -1;
  if (!call.good || (call.has(1) && joint < 0)) return {};
  if (call.has(1)) {
    done(sinew_character_set_joint_strength(character_, joint, strength), call.method, "the strength");
  } else if (done(sinew_character_set_strength(character_, strength), call.method, "the strength")) {
    strength_ = strength;
  }
  return {};
}

Value SinewCharacter::knock_down(Call& call) {
  if (!lives(call.method)) return {};
  rising_ = false;
  const sinew_root_drive root = balance_ ? SINEW_ROOT_GROUNDED : SINEW_ROOT_FREE;
  if (done(sinew_character_set_root_drive(character_, root), call.method, asset_path_))
    done(balance_ ? sinew_character_order(character_, SINEW_BEHAVIOUR_KNOCK_DOWN)
                  : sinew_character_set_strength(character_, 0),
         call.method, asset_path_);
  return {};
}

Value SinewCharacter::get_up(Call& call) {
  if (!lives(call.method)) return {};
  // Its root is led back, and has only the ground again, if it keeps its balance, when it is there.
  rising_ = done(balance_ ? sinew_character_order(character_, SINEW_BEHAVIOUR_STAND)
                          : sinew_character_set_strength(character_, strength_),
                 call.method, asset_path_) &&
            done(sinew_character_set_root_drive(character_, SINEW_ROOT_KINEMATIC), call.method, asset_path_);
  return {};
}

Value SinewCharacter::is_on_animation(Call& call) {
  return lives(call.method) && on_animation_;
}

Value SinewCharacter::unknown_dofs(Call& call) {
  sinew_character_report report{};
  report.size = sizeof report;
  if (lives(call.method)) done(sinew_character_get_report(character_, &report), call.method, asset_path_);
  return report.unknown_dofs;
}

Value SinewCharacter::pose_hash(Call& call) {
  auto hash = std::uint64_t(call.whole(0, "hash", std::int64_t(0xcbf29ce484222325u)));
  if (!lives(call.method) || !call.good) return 0;
  const sinew_view model = view(SINEW_VIEW_MODEL, call.method);
  for (std::int32_t j = 0; j < model.count; ++j) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(&joint_in(model, j));
    for (std::size_t k = 0; k < 7 * sizeof(float); ++k) hash = (hash ^ bytes[k]) * 0x100000001b3u;
  }
  return std::int64_t(hash);
}

// ---- Arguments and properties ----

bool SinewCharacter::lives(const char* method) const {
  if (!character_) godot::error(method, asset_path_ + ": this character is in no world");
  return character_ != 0;
}

int SinewCharacter::joint_of(Call& call, int argument) const {
  std::int32_t joint = -1;
  if (call.is(argument, kInt)) {
    const auto bone = call.whole(argument, "bone");
    if (bone >= 0 && bone < std::int64_t(bones_.size())) joint = bones_[std::size_t(bone)].joint;
    if (joint < 0)
      godot::error(call.method, "bone " + std::to_string(bone) + ": no joint of the asset leads it");
    return joint;
  }
  const std::string name = call.words(argument, "bone");
  if (call.good)
    done(sinew_asset_find_joint(asset_, name.c_str(), &joint), call.method, "bone \"" + name + "\"");
  return joint;
}

sinew_view SinewCharacter::view(sinew_view_kind kind, const char* method) const {
  sinew_view result{};
  done(sinew_character_get_view(character_, kind, &result), method, asset_path_);
  return result;
}

void SinewCharacter::set_asset_path(Call& call) {
  const std::string path = call.words(0, call.method);
  if (!call.good) return;
  if (asset_)
    return godot::error(call.method, asset_path_ + ": an asset is chosen before the node enters the tree");
  asset_path_ = path;
}

void SinewCharacter::set_clip_name(Call& call) {
  const std::string name = call.words(0, call.method);
  if (!call.good) return;
  if (character_) {
    play(call);
  } else {
    clip_name_ = name;
  }
}

void SinewCharacter::set_speed(Call& call) {
  const double speed = call.real(0, call.method);
  if (!call.good) return;
  began_ = next_time_;
  steps_ = 0;
  speed_ = speed;
}

void SinewCharacter::set_balance(Call& call) {
  const bool wanted = call.whole(0, call.method) != 0;
  if (!call.good) return;
  if (character_) return godot::error(call.method, "balance is chosen before the node enters the tree");
  balance_ = wanted;
}
