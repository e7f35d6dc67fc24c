#include "sinew_world.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "axes.h"
#include "sinew_character.h"

using godot::Call;
using godot::Object;
using godot::Value;

namespace {

std::unordered_map<Object*, SinewWorld*>& worlds() {
  static std::unordered_map<Object*, SinewWorld*> all;  // by node
  return all;
}

}  // namespace

bool done(sinew_status status, const char* method, const std::string& what) {
  if (status == SINEW_OK) return true;
  std::string words = what + ": " + sinew_last_reason() + " (" + sinew_status_name(status);
  if (const int index = sinew_last_index(); index >= 0) words += ", " + std::to_string(index);
  godot::error(method, words + ")");
  return false;
}

void SinewWorld::register_with_godot() {
  godot::Class<SinewWorld>("SinewWorld", "Spatial")
      .method<&SinewWorld::enter_tree>("_enter_tree")
      .method<&SinewWorld::physics_process>("_physics_process")
      .method<&SinewWorld::step>("step")
      .method<&SinewWorld::throw_ball>("throw_ball")
      .method<&SinewWorld::move_ball>("move_ball")
      .method<&SinewWorld::ball_transform>("ball_transform")
      .property<&SinewWorld::set_rate, &SinewWorld::rate>("steps_per_second", 60.0)
      .property<&SinewWorld::set_running, &SinewWorld::running>("running", true);
  godot::register_signal("SinewWorld", "stepped", {});
}

SinewWorld::SinewWorld(Object* self) : self_(self) {
  worlds()[self] = this;
}

SinewWorld::~SinewWorld() {
  worlds().erase(self_);
  for (SinewCharacter* character : characters_)
    if (character) character->leave();
  if (world_) sinew_world_destroy(world_);
}

SinewWorld* SinewWorld::above(Object* node) {
  for (node = godot::parent_of(node); node; node = godot::parent_of(node))
    if (const auto found = worlds().find(node); found != worlds().end()) return found->second;
  return nullptr;
}

void SinewWorld::remove(SinewCharacter* character) {
  std::replace(characters_.begin(), characters_.end(), character, static_cast<SinewCharacter*>(nullptr));
}

Value SinewWorld::enter_tree(Call& call) {
  if (world_ || !done(sinew_world_create(nullptr, &world_), call.method, "the world")) return {};
  sinew_contact_settings contacts{};
  contacts.size = sizeof contacts;
  if (!done(sinew_contact_settings_init(&contacts), call.method, "contacts")) return {};
  contacts.end = 0;
  done(sinew_world_report_contacts(world_, &contacts), call.method, "contacts");
  return {};
}

Value SinewWorld::physics_process(Call& call) {
  const double delta = call.real(0, "delta");
  if (!running_) return {};
  // A frame of as long as a step is one step, whatever its rounding.
  for (pending_ += delta; running_ && pending_ > 0.999 / steps_per_second_; pending_ -= 1 / steps_per_second_)
    advance(call.method);
  return {};
}

Value SinewWorld::step(Call& call) {
  advance(call.method);
  return {};
}

void SinewWorld::advance(const char* method) {
  const float h = 1 / float(steps_per_second_);
  bool good = world_ != 0;
  for (SinewCharacter* character : characters_)
    if (character) good = character->aim(h, steps_per_second_, method) && good;
  good = good && done(sinew_world_step(world_, h), method, "a step");
  if (!good) {
    running_ = false;
    godot::error(method, "the world stands still from here on (running = false)");
    return;
  }
  for (SinewCharacter* character : std::vector(characters_))  // scripts that hear of it may remove some
    if (character && std::count(characters_.begin(), characters_.end(), character)) character->show(method);
  tell_contacts(method);
  godot::emit(self_, "stepped", {});
}

void SinewWorld::tell_contacts(const char* method) {
  std::array<sinew_contact_event, 16> events;
  std::int32_t count = 0;
  const auto tell = [&](const sinew_contact_event& event, const sinew_body& body, int sign) {
    if (body.kind != SINEW_BODY_CHARACTER) return;
    if (SinewCharacter* const who = characters_[std::size_t(body.index)]) who->tell(event, sign);
  };
  do {
    if (!done(sinew_world_take_contacts(world_, events.data(), int(events.size()), &count, nullptr), method,
              "contacts"))
      return;
    for (std::int32_t i = 0; i < count; ++i) {
      tell(events[std::size_t(i)], events[std::size_t(i)].a, 1);
      tell(events[std::size_t(i)], events[std::size_t(i)].b, -1);
    }
  } while (count == int(events.size()));
}

// ---- Balls ----

Value SinewWorld::throw_ball(Call& call) {
  sinew_prop_settings settings{};
  settings.size = sizeof settings;
  if (!done(sinew_prop_settings_init(&settings), call.method, "a ball")) return -1;
  const auto at = axes::to_sinew(call.vector(0, "position")),
             velocity = axes::to_sinew(call.vector(1, "velocity"));
  settings.mass = call.real(2, "mass", settings.mass);
  settings.extent[0] = call.real(3, "radius", settings.extent[0]);
  if (!call.good) return -1;
  std::copy(at.begin(), at.end(), settings.pose.translation);
  std::copy(velocity.begin(), velocity.end(), settings.velocity);
  sinew_prop prop = 0;
  if (!done(sinew_world_add_prop(world_, &settings, &prop), call.method, "a ball")) return -1;
  return balls_++;
}

sinew_prop SinewWorld::ball(Call& call) const {
  const auto number = call.whole(0, "ball");
  sinew_prop prop = 0;
  if (call.good) done(sinew_world_get_prop(world_, std::int32_t(number), &prop), call.method, "a ball");
  return prop;
}

Value SinewWorld::move_ball(Call& call) {
  const sinew_prop prop = ball(call);
  const auto at = axes::to_sinew(call.vector(1, "position")),
             velocity = axes::to_sinew(call.vector(2, "velocity"));
  if (!call.good || !prop) return {};
  sinew_transform pose{{0, 0, 0, 1}, {float(at[0]), float(at[1]), float(at[2])}};
  const float moves[3] = {float(velocity[0]), float(velocity[1]), float(velocity[2])}, turns[3] = {0, 0, 0};
  done(sinew_prop_set_state(prop, &pose, moves, turns), call.method, "a ball");
  return {};
}

Value SinewWorld::ball_transform(Call& call) {
  sinew_transform pose{{0, 0, 0, 1}, {0, 0, 0}};
  if (const sinew_prop prop = ball(call); prop)
    done(sinew_prop_get_state(prop, &pose, nullptr), call.method, "a ball");
  return axes::to_godot(pose);
}

// ---- Properties ----

void SinewWorld::set_rate(Call& call) {
  const double wanted = call.real(0, call.method);
  if (!call.good) return;
  if (wanted >= 4 && wanted <= 1e5) {
    steps_per_second_ = wanted;
  } else {
    godot::error(call.method, "must be 4 to 100000, not " + std::to_string(wanted));
  }
}

void SinewWorld::set_running(Call& call) {
  const bool wanted = call.whole(0, call.method) != 0;
  if (call.good) running_ = wanted;
}
