// Random sequences of calls of the C interface, sensible and senseless: each answers with a status that
// exists and, where it refuses, with a reason; no pose is ever anything but finite. What else may go wrong is
// the sanitizers' to find.
//
//     SINEW_FUZZ_CALLS=1000000 c_fuzz_test     // longer
//     SINEW_SEED=17 c_fuzz_test                // the one sequence that failed
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "c/fuzz_motion.h"

namespace sinew {
namespace {

constexpr int kCallsOfASequence = 1000;
constexpr int kSteps = 8;  ///< of a sequence, the dearest of its calls

class Sequence : FuzzMotion {
 public:
  explicit Sequence(unsigned seed) : FuzzMotion(seed) { load(); }
  ~Sequence() {
    for (const std::uint64_t world : worlds_) sinew_world_destroy(world);
    for (const std::uint64_t graph : graphs_) sinew_graph_destroy(graph);
    for (const std::uint64_t asset : assets_) sinew_asset_destroy(asset);
  }
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  void call() {
    using Call = sinew_status (Sequence::*)();
    static constexpr Call kCalls[] = {
        &Sequence::step,    &Sequence::play,    &Sequence::play,  &Sequence::target,  &Sequence::target,
        &Sequence::push,    &Sequence::push,    &Sequence::set,   &Sequence::set,     &Sequence::world,
        &Sequence::asset,   &Sequence::person,  &Sequence::prop,  &Sequence::move,    &Sequence::loop,
        &Sequence::shape,   &Sequence::read,    &Sequence::read,  &Sequence::ask,     &Sequence::contacts,
        &Sequence::query,   &Sequence::draw,    &Sequence::save,  &Sequence::restore, &Sequence::record,
        &Sequence::balance, &Sequence::destroy, &Sequence::graph, &Sequence::follow,  &Sequence::follow,
        &Sequence::crowd,   &Sequence::crowd};
    const Call one = kCalls[below(std::size(kCalls))];
    check((this->*one)());
  }

 private:
  sinew_status load() {
    std::uint64_t asset = 0;
    const sinew_status status = sinew_asset_load(path_.c_str(), &asset);
    if (status == SINEW_OK) assets_.push_back(asset);
    return status;
  }
  sinew_status asset() {
    std::uint64_t out = 0;
    sinew_asset_info info{};
    info.size = sizeof info;
    sinew_joint_info joint{};
    joint.size = sizeof joint;
    sinew_clip_info clip{};
    clip.size = sizeof clip;
    std::int32_t found = 0;
    switch (below(7)) {
      case 0:
        return assets_.size() < 3 ? load() : sinew_asset_load("/nowhere", &out);
      case 1:
        return sinew_asset_read(or_null(bytes_.data()), bytes_.size(), &out);
      case 2:
        return sinew_asset_get_info(handle(assets_), or_null(&info));
      case 3:
        return sinew_asset_get_joint(handle(assets_), index(30), or_null(&joint));
      case 4:
        return sinew_asset_get_clip(handle(assets_), index(4), or_null(&clip));
      case 5:
        return sinew_asset_find_role(handle(assets_), index(25), or_null(&found));
      default:
        return sinew_asset_find_joint(handle(assets_), or_null("head"), or_null(&found));
    }
  }
  sinew_status world() {
    if (worlds_.size() >= 2) return sinew_world_create(nullptr, nullptr);
    sinew_world_settings s = settings(sinew_world_settings_init);
    if (below(3) == 0) s.gravity[2] = number(-20, 1);
    if (below(3) == 0) s.sleep_after = number(0, 1);
    if (below(3) == 0) s.workers = index(4);
    if (below(3) == 0) s.substeps = index(2);
    if (below(3) == 0) s.island_dofs = index(200);
    if (below(3) == 0) s.budget = number(0, 1e5);
    if (below(5) == 0) s.memory_cap = random_() % 8000000;
    s.restitution = below(2);
    s.continuous_detection = below(2);
    s.max_iterations = 6;  // what a step takes at most: calls are what is tried here, not solves
    s.max_passes = 12;
    s.max_splits = below(2);
    if (rarely()) s.tolerance = number(-1, 1);
    if (rarely()) check(sinew_world_settings_use_preset(&s, or_null("game")));
    std::uint64_t out = 0;
    const sinew_status status = sinew_world_create(&s, &out);
    if (status == SINEW_OK) worlds_.push_back(out);
    return status;
  }
  sinew_status person() {
    if (people_.size() >= 2) return sinew_world_get_character(handle(worlds_), index(8), or_null(&spare_));
    sinew_character_settings s = settings(sinew_character_settings_init);
    s.root = index(4);
    s.strength = number(0, 2);
    s.self_collision = below(2);
    s.most = index(6);
    s.check_every = index(4);
    s.bake = below(2);
    std::uint64_t out = 0;
    const sinew_status status =
        sinew_world_add_character(handle(worlds_), handle(assets_), or_null(&s), or_null(&out));
    if (status == SINEW_OK) people_.push_back(out);
    return status;
  }
  sinew_status crowd() {
    const std::uint64_t world = handle(worlds_);
    sinew_crowd_track track{index(12), index(2), number(-1, 5), number(-1, 2), {{0, 0, 0, 1}, {}}};
    if (rarely()) track.place.rotation[below(4)] = number(-1, 1);
    for (double& x : track.place.translation) x = number(-2, 2);
    sinew_crowd_member member{};
    member.size = sizeof member;
    sinew_crowd_report report{};
    report.size = sizeof report;
    sinew_view view{};
    std::vector<sinew_transform> models(std::size_t(below(400)));
    std::int32_t count = 0;
    float velocity[3];
    switch (below(12)) {
      case 9:
        return sinew_crowd_set_strength(world, index(12), real(0, 2));
      case 10:
        return sinew_crowd_get_track(world, index(12), or_null(&track));
      case 11:
        return sinew_crowd_get_root_velocity(world, index(12), or_null(velocity));
      case 0:
        return worlds_.size() < 3 ? make_crowd() : sinew_crowd_create(0, nullptr, nullptr, nullptr, nullptr);
      case 1:
        return sinew_crowd_get_member(world, index(12), or_null(&member));
      case 2:
        return sinew_crowd_get_report(world, or_null(&report));
      case 3:
        return sinew_crowd_get_model(world, index(12), or_null(&view));
      case 4:
        return sinew_crowd_copy_models(world, models.data(), static_cast<int>(models.size()),
                                       or_null(&count));
      case 5:
        return sinew_crowd_push(world, index(12), index(25), triple(rarely() ? 1e5 : 150));
      case 6:
        return sinew_crowd_stop(world, index(12));
      default:
        return sinew_crowd_play(world, or_null(&track), rarely() ? -1 : 1);
    }
  }
  sinew_status make_crowd() {
    sinew_crowd_settings s = settings(sinew_crowd_settings_init);
    s.capacity = index(12);
    s.places = index(3);
    s.lanes = rarely() ? index(3) : 8 * static_cast<int>(below(3));
    sinew_world_settings w = settings(sinew_world_settings_init);
    w.max_iterations = 6;
    w.max_passes = 12;
    std::uint64_t out = 0;
    const sinew_status status = sinew_crowd_create(handle(assets_), &s, or_null(&w), nullptr, or_null(&out));
    if (status == SINEW_OK) worlds_.push_back(out);
    return status;
  }
  sinew_status prop() {
    if (props_.size() >= 5) return sinew_world_get_prop(handle(worlds_), index(8), or_null(&spare_));
    sinew_prop_settings s = settings(sinew_prop_settings_init);
    s.shape = index(3);
    for (double& x : s.extent) x = number(0.02, 0.3);
    s.mass = number(0.1, 20);
    s.restitution = number(0, 1);
    if (below(3) == 0) s.meets = static_cast<std::uint32_t>(random_());
    turn(s.pose);
    for (double& x : s.velocity) x = number(-10, 10);
    std::uint64_t out = 0;
    const sinew_status status = sinew_world_add_prop(handle(worlds_), or_null(&s), or_null(&out));
    if (status == SINEW_OK) props_.push_back(out);
    return status;
  }
  sinew_status move() {
    sinew_transform pose{{0, 0, real(-0.1, 0.1), 1}, {real(-2, 2), real(-2, 2), real(0, 3)}};
    const float velocity[3] = {real(-5, 5), real(-5, 5), real(-5, 5)};
    const double* const way = triple(rarely() ? 1e3 : 0.05);
    const double ride[4] = {way ? way[0] : 0, way ? way[1] : 0, way ? way[2] : 0, number(-0.05, 0.05)};
    switch (below(8)) {
      case 7:
        return sinew_character_keep_out(handle(people_), number(-0.01, 0.05));
      case 6:
        return sinew_character_give_hand(handle(people_));
      case 4:
        return sinew_character_ride(handle(people_), or_null(ride));
      case 5:
        return sinew_character_come_back(handle(people_));
      case 0:
        return sinew_prop_set_state(handle(props_), or_null(&pose), or_null(velocity), velocity);
      case 1:
        return sinew_prop_park(handle(props_));
      case 2:
        return sinew_character_park(handle(people_), below(2));
      default:
        return sinew_character_reset(handle(people_));
    }
  }
  sinew_status loop() {
    if (loops_.size() >= 4) return sinew_loop_set_closed(handle(loops_), below(2));
    sinew_loop_settings s = settings(sinew_loop_settings_init);
    s.kind = index(5);
    s.length = number(0, 2);
    for (sinew_anchor* anchor : {&s.a, &s.b}) {
      anchor->kind = index(3);
      anchor->handle = handle(anchor->kind == SINEW_ANCHOR_PROP ? props_ : people_);
      anchor->joint = index(20);
      turn(anchor->pose);
    }
    std::uint64_t out = 0;
    const sinew_status status = sinew_world_add_loop(handle(worlds_), or_null(&s), or_null(&out));
    if (status == SINEW_OK) loops_.push_back(out);
    return status;
  }
  static double slope(void* context, const double* point, double* normal) {
    normal[0] = normal[1] = 0;
    normal[2] = 1;
    const double odd = *static_cast<const double*>(context);  // may be NaN
    return point[2] + odd;
  }
  sinew_status shape() {
    sinew_obstacle box = settings(sinew_obstacle_init);
    box.shape = index(3);
    for (double& x : box.extent) x = number(0.05, 0.5);
    turn(box.pose);
    const std::vector<double> heights(16, number(-0.2, 0.2));
    sinew_height_field field = settings(sinew_height_field_init);
    field.heights = or_null(heights.data());
    field.columns = field.rows = 4;
    sinew_host_shape host = settings(sinew_host_shape_init);
    depth_ = number(-0.1, 0.5);
    host.context = &depth_;
    host.distance = rarely() ? nullptr : slope;
    const double faces[3][4] = {{0, 0, 1, number(-0.2, 0.2)}, {0, 1, 0, number(0, 1)}, {1, 0, 0, 1}};
    sinew_convex_solid solid = settings(sinew_convex_solid_init);
    solid.faces = or_null(faces[0]);
    solid.face_count = rarely() ? -1 : below(4);
    double points[6][3];
    for (auto& point : points)
      for (double& x : point) x = number(-0.5, 0.5);
    if (shapes_ > 4) return SINEW_OK;
    ++shapes_;
    switch (below(5)) {
      case 4:
        return sinew_world_add_convex_obstacle(handle(worlds_), or_null(&box), or_null(points[0]),
                                               rarely() ? -1 : below(7));
      case 3:
        return sinew_world_add_convex_solid(handle(worlds_), or_null(&solid));
      case 0:
        return sinew_world_add_obstacle(handle(worlds_), or_null(&box));
      case 1:
        return sinew_world_add_height_field(handle(worlds_), or_null(&field));
      default:
        return sinew_world_add_host_shape(handle(worlds_), or_null(&host));
    }
  }
  sinew_status play() {
    const sinew_play plays[2] = {
        {handle(people_), handle(assets_), index(3), 0, number(-1, 10), number(0, 2), number(-1, 1)},
        {handle(people_), handle(assets_), 0, 0, number(0, 3), 1, 0}};
    return sinew_play_clips(or_null(plays), rarely() ? -below(3) : 1 + below(2));
  }
  sinew_status target() {
    std::vector<sinew_jet> jets(128);
    sinew_asset_info info{};
    info.size = sizeof info;
    const std::uint64_t asset = handle(assets_);
    check(sinew_asset_get_info(asset, &info));
    check(sinew_clip_sample(asset, index(2), number(0, 5), 1, 0, or_null(jets.data()), info.joints));
    if (rarely()) jets[std::size_t(below(20))].rotation[below(4)] = real(-1, 1);
    if (rarely()) jets[0].acceleration[below(3)] = real(-1e9, 1e9);
    if (rarely()) jets[0].translation[below(3)] = real(-10, 10);
    return sinew_character_set_target(handle(people_), or_null(jets.data()),
                                      rarely() ? index(128) : info.joints);
  }
  sinew_status balance() {
    std::vector<sinew_jet> jets(128);
    sinew_behaviour_settings s = settings(sinew_behaviour_settings_init);
    s.reaction = number(0, 0.3);
    s.get_up = index(3);
    s.gather = number(0.1, 1);
    s.rise_torque = number(0, 100);
    std::array<sinew_behaviour_event, 4> events;
    std::int32_t count = 0;
    sinew_asset_info info{};
    info.size = sizeof info;
    if (!assets_.empty()) {
      check(sinew_asset_get_info(assets_[0], &info));
      check(sinew_clip_sample(assets_[0], 0, number(0, 5), 1, 0, jets.data(), info.joints));
    }
    sinew_behaviour_report report{};
    report.size = sizeof report;
    std::size_t size = 0;
    switch (below(9)) {
      case 0:
        return sinew_character_add_behaviour(handle(people_), or_null(&s));
      case 1:
        return sinew_character_order(handle(people_), index(3));
      case 2:
        return sinew_character_get_behaviour(handle(people_), or_null(&report));
      case 3:
        return sinew_character_use_get_ups(handle(people_), handle(assets_));
      case 4:
        return sinew_character_get_behaviour_events(handle(people_), or_null(events.data()), index(5),
                                                    or_null(&count));
      case 5: {
        balanced_.resize(1 << 16);
        const sinew_status status = sinew_character_save_behaviour(handle(people_), or_null(balanced_.data()),
                                                                   balanced_.size(), or_null(&size));
        balanced_.resize(status == SINEW_OK ? size : 0);
        return status;
      }
      case 6:
        if (!balanced_.empty() && below(4) == 0)
          balanced_[std::size_t(below(balanced_.size()))] ^= char(1 << below(8));
        return sinew_character_restore_behaviour(handle(people_), or_null(balanced_.data()),
                                                 balanced_.size());
      default:
        return sinew_character_balance(handle(people_), or_null(jets.data()), info.joints, real(0.005, 0.03));
    }
  }
  sinew_status push() {
    if (below(2) == 0)
      return sinew_character_apply_force(handle(people_), index(25), triple(2), triple(2000));
    return sinew_character_apply_impulse(handle(people_), index(25), triple(2), triple(rarely() ? 1e5 : 150));
  }
  sinew_status set() {
    const std::uint64_t someone = handle(people_);
    switch (below(10)) {
      case 0:
        if (below(4) == 0) return sinew_character_set_self_collision(someone, index(2));
        return sinew_character_set_strength(someone, real(0, 2));
      case 1: {
        const std::vector<float> shares(128, rarely() ? 2 : real(0, 1));
        if (below(2) == 0) return sinew_character_set_activation(someone, or_null(shares.data()), index(128));
        return sinew_character_set_joint_strength(someone, index(25), real(0, 2));
      }
      case 2:
        return sinew_character_set_muscle_strength(someone, index(4), real(0, 2));
      case 3:
        return sinew_character_set_group_strength(someone, or_null("arm"), real(0, 2));
      case 4:
        return sinew_character_set_root_drive(someone, index(4));
      case 5:
        return sinew_character_set_help(someone, number(-1, 100), number(-1, 100));
      case 6:
        return sinew_character_set_detail(someone, number(0, 2), index(6), index(4), below(2));
      case 7:
        return sinew_character_displace(someone, triple(1));
      case 8: {
        double rise = 0;
        const sinew_status status = sinew_character_get_rise(someone, or_null(&rise));
        return rise > 0 ? status : sinew_character_raise(someone, real(-1, 1));
      }
      default:
        return sinew_character_take_displacement(someone);
    }
  }
  sinew_status step() {
    const std::uint64_t world = handle(worlds_);
    if (steps_ > kSteps) return sinew_world_step(world, -1);
    ++steps_;
    const sinew_status status = sinew_world_step(world, rarely() ? real(-1, 1) : 1 / 60.f);
    check_poses(world);
    return status;
  }
  sinew_status read() {
    sinew_character_report report{};
    report.size = rarely() ? std::uint32_t(below(1000)) : sizeof report;
    sinew_view view{};
    sinew_transform pose{};
    double numbers[3];
    float force[3];
    std::int32_t level = 0, flag = 0, every = 0;
    switch (below(10)) {
      case 6:
        return sinew_character_get_strength(handle(people_), or_null(force));
      case 7:
        return sinew_character_get_detail(handle(people_), or_null(numbers), or_null(&level), &every, &flag);
      case 8:
        return sinew_character_get_parked(handle(people_), or_null(&flag));
      case 9: {
        double place[3], velocity[3];
        return sinew_character_get_ground(handle(people_), or_null(numbers), place, or_null(velocity),
                                          numbers + 1);
      }
      case 0:
        return sinew_character_get_report(handle(people_), or_null(&report));
      case 1:
        return sinew_character_get_view(handle(people_), index(6), or_null(&view));
      case 2:
        return sinew_prop_get_state(handle(props_), or_null(&pose), or_null(force));
      case 3:
        return sinew_loop_get_state(handle(loops_), or_null(numbers), or_null(force));
      case 4:
        return sinew_character_get_displacement(handle(people_), or_null(numbers));
      default:
        return sinew_character_get_muscle_torque(handle(people_), index(3), or_null(force));
    }
  }
  sinew_status ask() {
    sinew_world_report report{};
    report.size = sizeof report;
    std::uint64_t bytes = 0;
    std::vector<sinew_transform> models(std::size_t(below(200)));
    std::int32_t count = 0;
    sinew_snapshot_field field{};
    const sinew_body a{index(6), index(3), 0}, b{index(6), index(3), 0};
    switch (below(6)) {
      case 5:
        return sinew_world_keep_apart(handle(worlds_), or_null(&a), or_null(&b), below(2));
      case 3:
        return sinew_world_get_count(handle(worlds_), index(6), or_null(&count));
      case 4:
        return sinew_world_get_snapshot_field(handle(worlds_), random_() % 4000, or_null(&field));
      case 0:
        return sinew_world_get_report(handle(worlds_), or_null(&report));
      case 1:
        return sinew_world_get_memory(handle(worlds_), or_null(&bytes));
      default:
        return sinew_world_copy_models(handle(worlds_), models.data(), static_cast<int>(models.size()),
                                       or_null(&count));
    }
  }
  sinew_status contacts() {
    sinew_contact_settings s = settings(sinew_contact_settings_init);
    s.capacity = index(64);
    s.stay = below(2);
    if (below(4) == 0) return sinew_world_report_contacts(handle(worlds_), or_null(&s));
    std::array<sinew_contact_event, 8> events;
    std::int32_t count = 0;
    return sinew_world_take_contacts(handle(worlds_), or_null(events.data()), rarely() ? -1 : 8,
                                     or_null(&count), nullptr);
  }
  sinew_status query() {
    sinew_query q = settings(sinew_query_init);
    for (int k = 0; k < 3; ++k) {
      q.origin[k] = number(-2, 2);
      q.motion[k] = number(-5, 5);
      if (below(3) == 0) q.half_axis[k] = number(-0.5, 0.5);
    }
    q.radius = number(0, 0.5);
    q.kinds = static_cast<std::uint32_t>(random_());
    if (below(4) == 0) q.without_character = handle(people_);
    if (below(4) == 0)
      q.accept = [](void*, const sinew_body* body) -> std::int32_t { return body->index % 2; };
    std::array<sinew_hit, 4> hits;
    std::int32_t count = 0;
    if (below(3) == 0) return sense(q);
    const auto find = below(2) == 0 ? sinew_world_cast : sinew_world_overlap;
    return find(handle(worlds_), or_null(&q), or_null(hits.data()), rarely() ? index(4) % 5 : 4,
                or_null(&count));
  }
  sinew_status sense(const sinew_query& q) {
    std::array<sinew_sensor_event, 4> events;
    std::array<sinew_body, 4> bodies;
    std::int32_t count = 0;
    std::uint64_t out = 0;
    switch (sensors_.size() < 3 ? 0 : below(4)) {
      case 0: {
        const sinew_status status =
            sinew_world_add_sensor(handle(worlds_), or_null(&q), rarely() ? index(4) : 4, or_null(&out));
        if (status == SINEW_OK) sensors_.push_back(out);
        return status;
      }
      case 1:
        return sinew_sensor_place(handle(sensors_), or_null(&q));
      case 2:
        check(sinew_sensor_update(handle(sensors_), or_null(&count)));
        return sinew_sensor_get_events(handle(sensors_), or_null(events.data()), rarely() ? -1 : below(5),
                                       or_null(&count));
      default:
        return sinew_sensor_get_bodies(handle(sensors_), or_null(bodies.data()), below(5), or_null(&count));
    }
  }
  sinew_status draw() {
    sinew_draw_settings s = settings(sinew_draw_settings_init);
    s.context = &lines_;
    s.line = [](void* lines, const double*, const double*, std::uint32_t) { ++*static_cast<long*>(lines); };
    return sinew_world_draw(handle(worlds_), or_null(&s));
  }
  sinew_status save() {
    std::size_t size = 0;
    bytes_.resize(rarely() ? 7 : 1 << 16);
    const sinew_status status =
        sinew_world_save(handle(worlds_), index(2), bytes_.data(), bytes_.size(), or_null(&size));
    bytes_.resize(status == SINEW_OK ? size : 0);
    return status;
  }
  sinew_status restore() {
    if (!bytes_.empty() && below(4) == 0) bytes_[std::size_t(below(bytes_.size()))] ^= char(1 << below(8));
    const sinew_status status =
        sinew_world_restore(handle(worlds_), index(2), or_null(bytes_.data()), bytes_.size());
    return status;
  }
  sinew_status record() {
    const std::uint64_t world = handle(worlds_);
    sinew_replay_report report{};
    report.size = sizeof report;
    sinew_view view{};
    switch (below(3)) {
      case 0:
        return sinew_world_record(world, below(2));
      case 1:
        if (sinew_world_get_recording(world, &view) == SINEW_OK)
          recording_.assign(static_cast<const char*>(view.data),
                            static_cast<const char*>(view.data) + view.count);
        return sinew_world_get_recording(world, or_null(&view));
      default:
        if (recording_.size() > 100000) recording_.resize(100000);  // a few steps
        return sinew_world_replay(world, recording_.data(), recording_.size(), or_null(&report));
    }
  }
  sinew_status destroy() {
    if (below(3) != 0) return SINEW_OK;
    std::vector<std::uint64_t>& of = below(4) == 0 ? assets_ : worlds_;
    if (of.empty()) return SINEW_OK;
    const std::uint64_t one = of[std::size_t(below(of.size()))];
    const bool world = &of == &worlds_;
    check(world ? sinew_world_destroy(one) : sinew_asset_destroy(one));
    std::erase(of, one);
    gone_.push_back(one);
    if (world)
      for (auto* inside : {&people_, &props_, &loops_, &effects_, &bodies_, &sensors_}) {
        const auto gone = [&](std::uint64_t h) {
          return (h << 4 >> 24) == (one << 4 >> 24);
        };  // its slot and serial
        std::copy_if(inside->begin(), inside->end(), std::back_inserter(gone_), gone);
        std::erase_if(*inside, gone);
      }
    return world ? sinew_world_destroy(one) : sinew_asset_destroy(one);  // twice
  }

  const std::string path_ = fixtures::sample_asset();
  std::uint64_t spare_ = 0;
  std::vector<char> bytes_, recording_;
  double depth_ = 0;
  long lines_ = 0;
  int shapes_ = 0, steps_ = 0;
};

long from_environment(const char* name, long otherwise) {
  const char* const value = std::getenv(name);
  return value ? std::atol(value) : otherwise;
}

TEST(CInterfaceFuzz, RandomCallsAnswerWithAStatus) {
  const long seed = from_environment("SINEW_SEED", -1);
  const long calls = seed >= 0 ? kCallsOfASequence : from_environment("SINEW_FUZZ_CALLS", 100000);
  std::printf("seeds:");
  for (long begun = 0, n = seed >= 0 ? seed : 1; begun < calls; begun += kCallsOfASequence, ++n) {
    std::printf(" %ld", n);
    std::fflush(stdout);  // the last one, where it crashes
    Sequence sequence(static_cast<unsigned>(n));
    for (int k = 0; k < kCallsOfASequence && !testing::Test::HasFatalFailure(); ++k) sequence.call();
    ASSERT_FALSE(HasFatalFailure()) << "SINEW_SEED=" << n;
  }
  std::printf("\n");
}

}  // namespace
}  // namespace sinew
