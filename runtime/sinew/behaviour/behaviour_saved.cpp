// What a behaviour remembers from one step to the next, as bytes: a digest, and a list of fields whose size
// is set-up.
#include <cstring>

#include "sinew/behaviour/behaviour.h"
#include "sinew/skeleton/byte_stream.h"
#include "sinew/skeleton/digest.h"

namespace sinew {
namespace {

using Digest = std::uint64_t;

template <class S>
void visit_jet(const char* name, TimeJet<S>& jet, ByteStream& stream) {
  for (S* number : {&jet.value, &jet.rate, &jet.acceleration}) stream.value(name, *number);
}

template <class S>
void visit_transform(const char* name, Transform<S>& transform, ByteStream& stream) {
  stream.rotation(name, transform.rotation);
  stream.vector(name, transform.translation);
}

template <class T>
void visit_joint(const char* name, JointJet<T>& jet, ByteStream& stream) {
  stream.rotation(name, jet.rotation);
  for (Vec3<T>* v : {&jet.omega, &jet.alpha, &jet.translation, &jet.velocity, &jet.acceleration})
    stream.vector(name, *v);
}

void visit_pendulum(const char* name, Pendulum& pendulum, ByteStream& stream) {
  for (Vec2* v : {&pendulum.place, &pendulum.velocity, &pendulum.acceleration}) stream.vector(name, *v);
}

/// `offsets`: what `fade` points to.
template <class T>
void visit_fade(InertialState<T>& fade, std::vector<T>& offsets, ByteStream& stream) {
  stream.value("time since a fade began", fade.elapsed);
  stream.value("duration of a fade", fade.duration);
  stream.array("offsets of a fade", offsets.data(), offsets.size());
}

void visit_report(BehaviourReport& report, ByteStream& stream) {
  auto& [state, steps, capture_depth, time, fell_beyond, tries] =
      report;  // a new member will not compile here
  stream.enumeration("what it does", state, BehaviourState::kRise);
  stream.value("steps since the push", steps);
  stream.value("depth of the capture point", capture_depth);
  stream.value("time since the push", time);
  stream.value("what it fell beyond", fell_beyond);
  stream.value("tries to get up", tries);
}

void visit_frame(const char* name, CarriedFrame& frame, ByteStream& stream) {
  stream.vector(name, frame.place);
  stream.vector(name, frame.velocity);
  stream.value(name, frame.turn_rate);
}

template <class T>
void visit_placed(FootState<T>& foot, ByteStream& stream) {
  auto& [hold, started, ground, point, normal, lock, height, slope, offset, grip, elapsed, duration] = foot;
  stream.enumeration("what of a placed foot stays", hold, FootHold::kHeel);
  stream.flag("a placed foot has a ground", started);
  stream.value("ground of a placed foot", ground);
  for (std::array<T, 3>* v : {&point, &normal, &lock})
    for (T& number : *v) stream.value("plane and lock of a placed foot", number);
  visit_jet("height of a placed foot", height.x, stream);
  for (SmoothInput<T>& one : slope) visit_jet("slope of a placed foot", one.x, stream);
  for (TimeJet<T>& one : offset) visit_jet("offset of a placed foot", one, stream);
  visit_jet("grip of a placed foot", grip, stream);
  stream.value("time of a placed foot", elapsed);
  stream.value("duration of a placed foot", duration);
}

void visit_last_step(LastStep& last, ByteStream& stream) {
  stream.vector("momentum", last.momentum);
  stream.flag("root was solved for", last.root_unknown);
  stream.value("force of the ground", last.ground.force);
  stream.vector("place of the ground", last.ground.place);
  stream.vector("velocity of the ground", last.ground.velocity);
  stream.value("turn rate of the ground", last.ground.turn_rate);
  stream.vector("normal of the ground", last.ground.normal);
  stream.value("depth in the ground", last.ground.depth);
}

}  // namespace

template <class T>
void GetUp<T>::visit(ByteStream& stream) {
  stream.value("clips that failed", tried_);
  stream.flag("rises", rises_);
  stream.value("pose to rise from", entry_);
  stream.value("clip to get up by", variant_);
  stream.value("times it gathered", gathers_);
  stream.value("time of this try", elapsed_);
  stream.value("time it waits", waits_);
  stream.value("off its clip", off_);
  stream.value("share of its strength", strong_from_);
  stream.value("off its clip as it began to rise", caught_);
  for (double* number : {&place_.x, &place_.y, &place_.yaw, &place_.z})
    stream.value("place of the clip", *number);
  stream.value("ground of the clip", ground_);
  stream.vector("slope of the clip's ground", normal_);
  visit_jet("time in the clip", time_, stream);
  stream.value("change of the clip's rate", rate_change_);
  visit_fade(fade_, fade_numbers_, stream);
  if (stream.reading() && variant_ >= 0) clips_.sample(variant_, ClipTime{time_}, pose_);
}

template <class T>
void Behaviour<T>::visit(ByteStream& stream) {
  visit_report(report_, stream);
  visit_pendulum("plan", plan_, stream);
  stream.value("frequency of the plan", frequency_);
  for (int a = 0; a < 2; ++a) stream.value("capture point ahead of the plan's", ahead_[a]);
  for (Transform<double>& foot : foot_) visit_transform("foot", foot, stream);
  stream.value("foot in the air", swing_);
  stream.value("foot that is put back", home_);
  stream.value("time of the swing", swing_time_);
  stream.value("duration of the swing", swing_lasts_);
  stream.flag("walks on", walks_);
  stream.value("standing foot of the walk", stance_);
  stream.value("pace of the walk", pace_);
  stream.flag("the other foot has left the ground", swung_);
  stream.value("time in which it lands", lands_in_);
  stream.flag("landed before its animation's", early_);
  for (int a = 0; a < 2; ++a) stream.value("where its animation's lands", lands_[a]);
  stream.flag("asked to come back", comes_back_);
  stream.value("animation sunk", sunk_);
  stream.value("ground of the animation", ground_);
  visit_pendulum("off the animation", error_, stream);
  for (MovingVector<double>& offset : foot_offset_)
    for (int a = 0; a < 3; ++a) visit_jet("foot off the animation", offset[a], stream);
  visit_transform("where the foot was lifted", lifted_, stream);
  stream.vector("turn of the trunk", turn_);
  stream.vector("angular velocity of the trunk", turn_rate_);
  stream.vector("angular acceleration of the trunk", turn_acceleration_);
  stream.vector("angular velocity of the root", spin_);
  visit_jet("height", height_, stream);
  stream.value("speed upwards", rises_);
  stream.value("time in the air", airborne_);
  stream.enumeration("how far it is with landing", landing_, Landing::kLanded);
  stream.rotation("root a step before", root_before_);
  stream.value("level of the ground", level_);
  stream.flag("something has borne it", leveled_);
  stream.vector("slope of the ground", normal_);
  stream.value("ground higher than the clip's", higher_);
  stream.flag("root was measured", measured_);
  reach_.visit(stream);
  stream.value("time it has lain still", rest_);
  stream.flag("may get up", allowed_);
  stream.flag("knocked down", knocked_);
  stream.flag("has just got up", risen_);
  stream.flag("waits until it may set off", waits_);
  stream.value("time in which it sets off", sets_off_);
  for (FootState<T>& foot : placed_) visit_placed(foot, stream);
  visit_jet("lowered while it sets off", lowered_.x, stream);
  stream.value("ground of the animation before it fell", stood_on_);
  for (JointJet<T>& jet : last_) visit_joint("last target", jet, stream);
  stream.flag("there was a target", asked_);
  stream.flag("a fade begins", fades_);
  stream.flag("a fade takes the root along", fades_root_);
  visit_fade(fade_, fade_numbers_, stream);
  visit_fade(placing_, placing_numbers_, stream);
  visit_last_step(last_step_, stream);
  visit_frame("ground a step before", ground_before_, stream);
  stream.value("slip if taken along", slip_ridden_);
  stream.value("slip if not", slip_led_);
  stream.flag("goes along by itself", led_);
  get_up_.visit(stream);
}

/// Of saved bytes, and of what they were saved by.
template <class T>
std::uint64_t Behaviour<T>::check_of(std::span<const std::byte> bytes) const {
  const std::array<int, 2> clips{static_cast<int>(get_up_.clips().variants().size()),
                                 get_up_.clips().entries()};
  return digest(bytes, digest(std::as_bytes(std::span(clips))));
}

template <class T>
std::size_t Behaviour<T>::saved_bytes() {
  ByteStream stream = ByteStream::bound();
  visit(stream);
  return sizeof(Digest) + stream.position();
}

template <class T>
std::size_t Behaviour<T>::save(const Character<T>& character, std::span<std::byte> out) {
  const std::size_t size = saved_bytes();
  if (out.size() < size || !character.valid()) return 0;
  if (!restored_) {
    look_back(character);
    last_step_.momentum = character.report().momentum;
  }
  const std::span<std::byte> body = out.subspan(sizeof(Digest), size - sizeof(Digest));
  ByteStream stream = ByteStream::writer(body);
  visit(stream);
  const Digest check = check_of(body);
  std::memcpy(out.data(), &check, sizeof check);
  return size;
}

template <class T>
Status Behaviour<T>::restore(std::span<const std::byte> saved) {
  if (saved.size() != saved_bytes())
    return Status::error(Code::kInvalidArgument, "not what such a behaviour saved: another size");
  const std::span<const std::byte> body = saved.subspan(sizeof(Digest));
  Digest check = 0;
  std::memcpy(&check, saved.data(), sizeof check);
  if (check != check_of(body))
    return Status::error(Code::kBadFile,
                         "what was saved is damaged, or a behaviour with other clips saved it");
  ByteStream stream = ByteStream::reader(body);
  visit(stream);
  find_support();
  if (home_ >= 0) find_only();
  restored_ = true;
  events_count_ = 0;
  return {};
}

#define SINEW_SAVED_INSTANCES(T)                                                      \
  template void GetUp<T>::visit(ByteStream&);                                         \
  template void Behaviour<T>::visit(ByteStream&);                                     \
  template std::uint64_t Behaviour<T>::check_of(std::span<const std::byte>) const;    \
  template std::size_t Behaviour<T>::saved_bytes();                                   \
  template std::size_t Behaviour<T>::save(const Character<T>&, std::span<std::byte>); \
  template Status Behaviour<T>::restore(std::span<const std::byte>);
SINEW_SAVED_INSTANCES(float)
SINEW_SAVED_INSTANCES(double)

}  // namespace sinew
