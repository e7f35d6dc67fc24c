// Whole steps of a world: the wheel on its animation, and things that are solved for.
#include <cstdlib>
#include <limits>

#include "sinew/character/world.h"
#include "study/effect_cost/figure.h"
#include "study/effect_cost/modules.h"
#include "study/effect_cost/work.h"

namespace sinew::study {
namespace {

constexpr int kSettling = 30;  ///< steps until what was set down rests

WorldSettings nothing_declared() {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.ground = false;
  settings.detail.sleep_after = 0;
  return settings;
}

void check(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", status.reason);
  std::exit(3);
}

/// The wheel plays; rods are pushed, stand on the floor, or are acted on by a module.
struct Checked : Work {
  std::string effect;
  int instances;
  World<float> world;
  std::size_t effect_bytes = 0;

  Checked(std::string what, int count)
      : effect(std::move(what)), instances(count), world(settings(effect, count), DeclareNothing{}) {
    Status status;
    BuiltIn on{.muscles = kRods};
    if (effect == "support") on.colliders = instances;
    const Skeleton s = wheel(on);
    const bool declared_by_type = declare_module(effect, world);
    constexpr double boundless = std::numeric_limits<double>::infinity();
    CharacterSettings figure;
    figure.strength = effect == "muscles" ? 1 : boundless;
    (void)world.add_character(s, figure, status);
    check(status);
    check(world.character(0).set_target(at_rest(s)));
    (void)world.character(0).reset();
    for (int i = instances; effect == "muscles" && i < kRods; ++i)
      check(world.character(0).set_strength(i + 1, boundless));
    if (effect == "none" || effect == "gravity" || declared_by_type) return;
    auto made = make_module(effect, first_rods(instances));
    if (!made) unknown(effect);
    const Effect<float>& declared = *made;
    check(world.add_effect(0, std::move(made)));
    effect_bytes = declared.bytes();
  }
  static WorldSettings settings(const std::string& effect, int count) {
    WorldSettings s = nothing_declared();
    if (effect == "support" || (effect == "gravity" && count > 0)) s.gravity.z() = -9.81;
    s.ground = effect == "support";
    s.ground_height = -0.05;
    return s;
  }
  void prepare() override {
    Character<float> figure = world.character(0);
    for (int i = 0; effect == "impulses" && i < instances; ++i)
      check(figure.apply_force(i + 1, figure.model()[i + 1].translation, {0.1f / kStep, 0, 0.1f / kStep}));
  }
  void step() override { (void)world.step(kStep); }
  std::size_t bytes() const override { return effect_bytes; }
};

/// So many things on their own, each an island, or tied to one limp wheel.
struct Solved : Work {
  World<float> world;
  std::string effect;
  std::vector<double> radii;  ///< [ball]
  std::size_t without = 0;

  Solved(const std::string& what, int instances) : world(settings(what), DeclareNothing{}), effect(what) {
    if (effect == "loops")
      add_limp_wheel();
    else if (effect != "none" && !declare_module("contacts", world))
      unknown(effect);
    without = world.memory().characters;
    if (effect == "prop" || effect == "resting_prop" || effect == "prop_contact") {
      for (int i = 0; i < instances; ++i) add_props(i);
    } else if (has_balls()) {
      for (int i = 0; i < kRods; ++i) add_ball(i < instances);
      if (effect == "continuous_detection") check(world.add_obstacle(plate()));
      without = world.memory().characters;
      if (instances > 0 && !declare_module(effect, world)) unknown(effect);
    } else if (effect != "none") {
      check(add_ties(effect, instances, world));
    }
    if (effect == "none" || has_balls()) return;
    for (int n = 0; n < kSettling; ++n) step();
  }
  static WorldSettings settings(const std::string& effect) {
    WorldSettings s = nothing_declared();
    s.ground = effect == "resting_prop" || effect == "prop_contact" || effect == "restitution";
    if (s.ground) s.gravity.z() = -9.81;
    return s;
  }
  /// Far enough from each other.
  static Transform<double> place(int i, double height) {
    Transform<double> at;
    const int row = i / 8;
    at.translation = {3.0 * (i % 8), 3.0 * row, height};
    return at;
  }
  void add_limp_wheel() {
    Status status;
    CharacterSettings limp;
    limp.strength = 0;
    const Skeleton s = wheel({.colliders = 0});
    (void)world.add_character(s, limp, status);
    check(status);
    check(world.character(0).set_target(at_rest(s)));
    (void)world.character(0).reset();
  }
  void add_props(int i) {
    Status status;
    PropSettings box;
    box.shape = Shape::kBox;
    box.pose = place(i, effect == "prop" ? 10 : 0.1);
    if (effect == "prop") box.velocity = {0.01, 0, 0};
    (void)world.add_prop(box, status);
    check(status);
    if (effect != "prop_contact") return;
    box.pose = place(i, 0.3);
    (void)world.add_prop(box, status);
    check(status);
  }
  bool has_balls() const { return effect == "restitution" || effect == "continuous_detection"; }
  /// One that bounces, or is small enough to pass the plate; the others do neither.
  void add_ball(bool acted_on) {
    Status status;
    PropSettings ball;
    if (effect == "restitution") ball.restitution = acted_on ? 0.5 : 0;
    if (effect == "continuous_detection") ball.size.setConstant(acted_on ? 0.02 : 0.2);
    radii.push_back(ball.size.x());
    (void)world.add_prop(ball, status);
    check(status);
  }
  /// A thin one below all balls.
  static Collider plate() {
    Collider box;
    box.shape = Shape::kBox;
    box.size = {100, 100, 0.005};
    return box;
  }
  /// Balls drop onto the floor anew, or fly along the plate.
  void prepare() override {
    if (!has_balls()) return;
    const bool drop = effect == "restitution";
    for (int i = 0; i < world.prop_count(); ++i)
      (void)world.set_prop(i, place(i, radii[i] + 0.01).cast<float>(),
                           drop ? Vec3<float>(0, 0, -3) : Vec3<float>(4, 0, 0), Vec3<float>::Zero());
  }
  void step() override { (void)world.step(kStep); }
  std::size_t bytes() const override { return world.memory().characters - without; }
};

}  // namespace

std::unique_ptr<Work> make_world(const std::string& mode, const std::string& effect, int instances) {
  if (mode == "checked") return std::make_unique<Checked>(effect, instances);
  if (mode == "step") return std::make_unique<Solved>(effect, instances);
  return nullptr;
}

}  // namespace sinew::study
