// Random calls of the C interface for what moves characters besides clips: graphs, effects, jobs on poses,
// tones, and what hangs on them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "c/fuzz_inputs.h"

namespace sinew {

class FuzzMotion : protected FuzzInputs {
 protected:
  using FuzzInputs::FuzzInputs;

  sinew_status graph() {
    std::uint64_t out = 0;
    sinew_graph_info info{};
    info.size = sizeof info;
    sinew_parameter_info parameter{};
    parameter.size = sizeof parameter;
    sinew_node_info node{};
    node.size = sizeof node;
    sinew_state_info state{};
    state.size = sizeof state;
    std::int32_t found = 0;
    switch (below(7)) {
      case 0: {
        if (graphs_.size() >= 3)
          return sinew_graph_read(or_null(remembered_.data()), remembered_.size(), handle(assets_), &out);
        const sinew_status status = sinew_graph_load(or_null(graph_path_.c_str()), handle(assets_), &out);
        if (status == SINEW_OK) graphs_.push_back(out);
        return status;
      }
      case 1:
        return sinew_graph_get_info(handle(graphs_), or_null(&info));
      case 2:
        return sinew_graph_get_parameter(handle(graphs_), index(4), or_null(&parameter));
      case 3:
        return sinew_graph_get_node(handle(graphs_), index(12), or_null(&node));
      case 4:
        return sinew_graph_get_state(handle(graphs_), index(12), index(5), or_null(&state));
      case 5:
        return sinew_graph_find_node(handle(graphs_), or_null("walk"), or_null(&found));
      default:
        if (graphs_.empty() || below(8) != 0) return SINEW_OK;
        gone_.push_back(graphs_.back());
        graphs_.pop_back();
        return sinew_graph_destroy(gone_.back());
    }
  }
  sinew_status add_graph() {
    sinew_graph_settings s = settings(sinew_graph_settings_init);
    s.events = index(9);
    s.place[0] = number(-2, 2);
    s.heading = number(-4, 4);
    s.ground = index(3);
    if (!rarely())
      s.below = [](void*, const float* point, sinew_ground_hit* hit) -> std::int32_t {
        hit->point[2] = point[0] > 0 ? 0.1f : std::nanf("");
        return point[1] > 0;
      };
    return sinew_character_add_graph(handle(people_), handle(graphs_), or_null(&s));
  }
  sinew_status follow() {
    const std::uint64_t someone = handle(people_);
    const sinew_graph_play plays[2] = {{someone, real(0, 0.1), 0}, {handle(people_), real(0, 0.02), 0}};
    sinew_parameter_value value{};
    sinew_machine_report machine{};
    machine.size = sizeof machine;
    sinew_graph_place place{};
    std::array<sinew_graph_event, 8> events;
    std::array<sinew_curve_value, 8> curves;
    std::vector<sinew_jet> jets(128);
    std::int32_t count = 0;
    std::size_t size = 0;
    switch (below(14)) {
      case 0:
        return add_graph();
      case 1:
        return sinew_character_set_parameter(someone, index(4), real(-1, 4));
      case 2:
        return sinew_character_set_parameter_by_name(someone, or_null("limp"), real(-1, 1));
      case 3:
        return sinew_character_trigger(someone, index(4));
      case 4:
        return sinew_character_get_parameter(someone, index(4), or_null(&value));
      case 5:
        return sinew_character_get_machine(someone, index(12), or_null(&machine));
      case 6:
        return sinew_character_get_graph_place(someone, or_null(&place));
      case 7:
        return sinew_character_put_graph(someone, triple(3), number(-4, 4));
      case 8:
        return sinew_character_get_graph_events(someone, or_null(events.data()), below(9), or_null(&count),
                                                nullptr);
      case 9:
        return sinew_character_get_graph_curves(someone, or_null(curves.data()), rarely() ? -1 : below(9),
                                                or_null(&count));
      case 10: {
        remembered_.resize(1 << 16);
        const sinew_status status = sinew_character_save_graph(someone, or_null(remembered_.data()),
                                                               remembered_.size(), or_null(&size));
        remembered_.resize(status == SINEW_OK ? size : 0);
        return status;
      }
      case 11:
        if (!remembered_.empty() && below(4) == 0)
          remembered_[std::size_t(below(remembered_.size()))] ^= char(1 << below(8));
        return sinew_character_restore_graph(someone, or_null(remembered_.data()), remembered_.size());
      case 12:
        return sinew_character_sample_graph(someone, real(0, 0.1), or_null(jets.data()),
                                            rarely() ? index(128) : joints());
      default:
        return sinew_play_graphs(or_null(plays), rarely() ? -1 : 1 + below(2));
    }
  }
  int joints() const {
    sinew_asset_info info{};
    info.size = sizeof info;
    return !assets_.empty() && sinew_asset_get_info(assets_[0], &info) == SINEW_OK ? info.joints : 0;
  }
  template <class S>
  void choose_joints(S& settings) {
    if (below(2) == 0) return;
    for (std::int32_t& joint : joints_) joint = index(22);
    settings.joints = or_null(joints_.data());
    settings.joint_count = rarely() ? -1 : below(joints_.size() + 1);
  }
  sinew_status effect() {
    sinew_wind wind = settings(sinew_wind_init);
    wind.velocity[0] = number(-20, 20);
    choose_joints(wind);
    sinew_buoyancy water = settings(sinew_buoyancy_init);
    water.level = number(-1, 2);
    choose_joints(water);
    sinew_force_field field = settings(sinew_force_field_init);
    field.acceleration = number(-30, 30);
    choose_joints(field);
    sinew_joint_spring spring = settings(sinew_joint_spring_init);
    spring.stiffness = number(0, 200);
    choose_joints(spring);
    std::uint64_t out = 0;
    const sinew_status status = effect(wind, water, field, spring, out);
    if (status == SINEW_OK && out != 0) effects_.push_back(out);
    return status;
  }
  sinew_status effect(const sinew_wind& wind, const sinew_buoyancy& water, const sinew_force_field& field,
                      const sinew_joint_spring& spring, std::uint64_t& out) {
    const std::uint64_t someone = handle(people_), thing = handle(props_), one = handle(effects_);
    switch (below(13)) {
      case 0:
        return sinew_character_add_wind(someone, or_null(&wind), or_null(&out));
      case 1:
        return sinew_character_add_buoyancy(someone, or_null(&water), or_null(&out));
      case 2:
        return sinew_character_add_force_field(someone, or_null(&field), or_null(&out));
      case 3:
        return sinew_character_add_joint_spring(someone, or_null(&spring), or_null(&out));
      case 4:
        return sinew_prop_add_wind(thing, or_null(&wind), or_null(&out));
      case 5:
        return sinew_prop_add_buoyancy(thing, or_null(&water), or_null(&out));
      case 6:
        return sinew_prop_add_force_field(thing, or_null(&field), or_null(&out));
      case 7:
        return sinew_effect_set_wind(one, or_null(&wind));
      case 8:
        return sinew_effect_set_buoyancy(one, or_null(&water));
      case 9:
        return sinew_effect_set_force_field(one, or_null(&field));
      case 10:
        return sinew_effect_set_joint_spring(one, or_null(&spring));
      case 11:
        return sinew_effect_remove(one);
      default:
        return sinew_character_remove_effects(someone);
    }
  }

  sinew_status pose() {
    std::vector<sinew_jet> jets(128), other(128);
    const std::uint64_t asset = handle(assets_);
    const int count = rarely() ? std::min(index(128), 128) : joints();
    check(sinew_clip_sample(asset, index(2), number(0, 3), 1, 0, jets.data(), count));
    check(sinew_clip_sample(asset, index(2), number(0, 3), 1, 0, other.data(), count));
    if (rarely()) jets[std::size_t(below(20))].rotation[below(4)] = real(-1, 1);
    switch (below(10)) {
      case 8:
        return place(asset, jets, count);
      case 9:
        return clip(asset);
      case 4:
        return change_over(asset, jets, other, count);
      case 5:
        return feet(asset, jets, count);
      case 6:
        return blend_in_model(asset, jets, other, count);
      case 0:
        return blend(asset, jets, other, count);
      case 1:
        return limb(asset, jets, count);
      case 2:
        return look(asset, jets, count);
      case 3:
        return sinew_asset_mirror(asset, or_null(jets.data()), count);
      default:
        return sinew_asset_subtract(asset, or_null(other.data()), below(2) * count, or_null(jets.data()),
                                    count);
    }
  }
  sinew_status place(std::uint64_t asset, std::vector<sinew_jet>& jets, int count) {
    sinew_pose to{};
    turn(to);
    sinew_jet travel, body, socket;
    const sinew_transform palm{{0, 0, 0, real(0.99, 1.005)}, {real(-0.1, 0.1), 0, 0}};
    switch (below(3)) {
      case 0:
        return sinew_place_jets(or_null(&to), or_null(jets.data()), count);
      case 1:
        return sinew_split_root(or_null(jets.data()), or_null(&travel), or_null(&body));
      default:
        return sinew_asset_get_socket(asset, or_null(jets.data()), count, index(22), or_null(&palm),
                                      or_null(&socket));
    }
  }
  sinew_status clip(std::uint64_t asset) {
    sinew_clip_passage passage = settings(sinew_clip_passage_init);
    passage.clip = index(6);
    passage.before = number(-3, 10);
    passage.now = passage.before + number(-1, 1);
    passage.weight = number(0, 1);
    passage.starts = below(2);
    std::array<sinew_graph_event, 4> events;
    std::array<sinew_curve_value, 4> curves;
    std::int32_t count = 0;
    const int room = rarely() ? -1 : below(5);
    switch (below(4)) {
      case 0:
        return sinew_asset_get_passed_events(asset, or_null(&passage), or_null(events.data()), room,
                                             or_null(&count));
      case 1:
        return sinew_asset_get_ended_events(asset, index(6), number(-3, 10), below(2), or_null(events.data()),
                                            room, or_null(&count));
      case 2:
        return sinew_asset_sample_curves(asset, index(6), number(-3, 10), number(-1, 2), number(-1, 1),
                                         or_null(curves.data()), room, or_null(&count));
      default:
        return sinew_smooth(or_null(&input_), real(-3, 3), real(0.01, 1), real(0, 0.1));
    }
  }
  /// Within one transition, or its beginning; some of its numbers get lost.
  sinew_status change_over(std::uint64_t asset, std::vector<sinew_jet>& jets,
                           const std::vector<sinew_jet>& other, int count) {
    std::int32_t numbers = 0;
    if (below(2) == 0) {
      transition_.resize(rarely() ? 100 : 3000);
      const sinew_status status = sinew_asset_begin_transition(
          asset, or_null(jets.data()), count, or_null(other.data()), rarely() ? 3 : count, real(-0.1, 1),
          transition_.data(), static_cast<int>(transition_.size()), or_null(&numbers));
      transition_.resize(status == SINEW_OK ? std::size_t(numbers) : 0);
      return status;
    }
    if (rarely() && !transition_.empty()) transition_[std::size_t(below(transition_.size()))] = real(-10, 99);
    return sinew_asset_play_transition(asset, or_null(transition_.data()),
                                       static_cast<int>(transition_.size()), real(0, 0.1),
                                       or_null(jets.data()), count);
  }
  sinew_status blend(std::uint64_t asset, std::vector<sinew_jet>& jets, const std::vector<sinew_jet>& other,
                     int count) {
    const std::vector<float> mask(128, real(0, 1));
    std::array<sinew_blend_layer, 3> layers;
    for (sinew_blend_layer& layer : layers)
      layer = {or_null(below(2) == 0 ? jets.data() : other.data()),
               below(2) == 0 ? nullptr : mask.data(),
               index(3),
               real(0, 1),
               real(-1, 1),
               real(-1, 1)};
    return sinew_asset_blend(asset, or_null(layers.data()), rarely() ? -1 : below(4), or_null(jets.data()),
                             count);
  }
  sinew_status blend_in_model(std::uint64_t asset, std::vector<sinew_jet>& jets,
                              std::vector<sinew_jet>& other, int count) {
    std::vector<sinew_jet> scratch(rarely() ? 3 : 256);
    const int memory = static_cast<int>(scratch.size());
    check(sinew_asset_subtract_in_model(asset, or_null(jets.data()), rarely() ? 3 : count,
                                        or_null(other.data()), count, or_null(scratch.data()), memory));
    const sinew_blend_layer layer = {
        or_null(other.data()), nullptr, rarely() ? index(4) : std::int32_t(SINEW_BLEND_ADDITIVE), real(0, 1),
        real(-1, 1),           0};
    return sinew_asset_add_in_model(asset, or_null(&layer), or_null(jets.data()), count,
                                    or_null(scratch.data()), memory);
  }
  sinew_status limb(std::uint64_t asset, std::vector<sinew_jet>& jets, int count) {
    sinew_two_bone two = settings(sinew_two_bone_init);
    two.upper = index(10);
    two.middle = two.upper + index(3);
    two.end = two.middle + index(3);
    sinew_aim aim = settings(sinew_aim_init);
    aim.joint = index(22);
    for (int k = 0; k < 3; ++k) two.target[k] = aim.target[k] = number(-1, 2);
    two.weight = aim.weight = number(0, 1);
    std::array<sinew_transform, 128> model;
    std::int32_t placed = 0;
    switch (below(3)) {
      case 0:
        return sinew_asset_two_bone(asset, or_null(&two), or_null(jets.data()), count);
      case 1:
        return sinew_asset_aim(asset, or_null(&aim), or_null(jets.data()), count);
      default:
        return sinew_asset_get_model(asset, or_null(jets.data()), count, or_null(model.data()),
                                     rarely() ? -1 : 128, or_null(&placed));
    }
  }
  sinew_status look(std::uint64_t asset, std::vector<sinew_jet>& jets, int count) {
    sinew_look look = settings(sinew_look_init);
    for (int k = 0; k < 3; ++k) {
      look.target[k] = number(-3, 3);
      look.before[k] = number(-3, 3);
    }
    look.changed = below(2);
    look.step = number(0, 0.1);
    look.half_life = number(0, 0.2);
    if (rarely()) look_.numbers[below(26)] = real(-1, 1);
    if (rarely()) look_ = {};
    return sinew_asset_look(asset, or_null(&look), or_null(&look_), or_null(jets.data()), count);
  }

  sinew_ground_hit hit() {
    sinew_ground_hit out{{real(-1, 1), real(-1, 1), real(-0.2, 0.3)}, {0, 0, 1}, rarely() ? index(3) : -1};
    if (rarely()) out.normal[below(3)] = real(-1, 1);
    return out;
  }
  /// Of one character, a frame after the other; some of what its feet remember gets lost.
  sinew_status feet(std::uint64_t asset, std::vector<sinew_jet>& jets, int count) {
    sinew_leg_info leg{};
    leg.size = sizeof leg;
    std::int32_t rests = 0;
    check(sinew_asset_get_leg(asset, below(2) == 0 ? index(22) : std::int32_t(SINEW_ROLE_FOOT_L),
                              or_null(&leg)));
    check(sinew_clip_in_contact(asset, index(2), number(0, 3), leg.foot, or_null(&rests)));
    sinew_feet s = settings(sinew_feet_init);
    s.level = number(-0.1, 0.2);
    s.level_rate = number(-1, 1);
    s.step = number(0, 0.1);
    if (rarely()) s.reach = number(0.4, 1);
    if (rarely()) s.release_at = number(0, 1);
    if (rarely()) s.half_life = number(0, 1);
    const sinew_ground_hit hits[2] = {hit(), hit()};
    sinew_foot feet[2];
    for (sinew_foot& foot : feet)
      foot = {or_null(&hits[0]), or_null(&hits[1]), rarely() ? -1 : 2, below(2), real(0, 1), 0};
    sinew_jet grounds[2] = {};
    for (sinew_jet& ground : grounds) ground.rotation[3] = rarely() ? real(-1, 1) : 1;
    if (rarely()) feet_.feet[below(2)].numbers[below(30)] = real(-1, 1);
    if (rarely()) feet_.feet[below(2)].hold = index(3);
    if (rarely()) feet_ = {};
    return sinew_asset_place_feet(asset, or_null(&s), or_null(feet), or_null(grounds), rarely() ? -1 : 2,
                                  or_null(&feet_), or_null(jets.data()), count);
  }

  sinew_status particles() {
    if (bodies_.size() > 2) return read_particles();
    sinew_strand strand = settings(sinew_strand_init);
    strand.particles = 1 + below(4);
    strand.frame.kind = index(3);
    strand.frame.handle = strand.frame.kind == SINEW_ANCHOR_CHARACTER ? handle(people_) : handle(props_);
    strand.frame.joint = index(22);
    strand.length = number(0.01, 0.5);
    constexpr double kCorners[12] = {0, 0, 1, 0.2, 0, 1, 0, 0.2, 1, 0, 0, 1.2};
    const std::int32_t elements[4] = {index(4), index(4), index(4), index(4)}, fixed[1] = {index(4)};
    sinew_cloth cloth = settings(sinew_cloth_init);
    sinew_soft_tissue tissue = settings(sinew_soft_tissue_init);
    cloth.positions = tissue.positions = or_null(kCorners);
    cloth.node_count = tissue.node_count = rarely() ? -1 : below(5);
    cloth.triangles = tissue.tetrahedra = or_null(elements);
    cloth.triangle_count = tissue.tetrahedron_count = below(2);
    cloth.fixed = tissue.fixed = or_null(fixed);
    cloth.fixed_count = tissue.fixed_count = below(2);
    std::uint64_t out = 0;
    const sinew_status status = particles(strand, cloth, tissue, out);
    if (status == SINEW_OK && out != 0) bodies_.push_back(out);
    return status;
  }
  sinew_status particles(const sinew_strand& strand, const sinew_cloth& cloth,
                         const sinew_soft_tissue& tissue, std::uint64_t& out) {
    switch (below(3)) {
      case 0:
        return sinew_world_add_strand(handle(worlds_), or_null(&strand), or_null(&out));
      case 1:
        return sinew_world_add_cloth(handle(worlds_), or_null(&cloth), or_null(&out));
      default:
        return sinew_world_add_soft_tissue(handle(worlds_), or_null(&tissue), or_null(&out));
    }
  }
  sinew_status read_particles() {
    std::array<sinew_particle, 8> nodes;
    std::int32_t count = 0;
    const float velocity[3] = {real(-1, 1), 0, 0};
    sinew_character_report report{};
    report.size = sizeof report;
    switch (below(3)) {
      case 0:
        return sinew_particles_get_nodes(handle(bodies_), or_null(nodes.data()), rarely() ? -1 : below(9),
                                         or_null(&count));
      case 1:
        return sinew_particles_reset(handle(bodies_), or_null(velocity));
      default:
        return sinew_particles_get_report(handle(bodies_), or_null(&report));
    }
  }
  sinew_status tone() {
    double stiffness = 0, ratio = 0;
    switch (below(4)) {
      case 0:
        return sinew_character_set_tone(handle(people_), index(4));
      case 1:
        return sinew_character_set_joint_tone(handle(people_), index(22), index(4));
      case 2:
        return sinew_character_set_joint_stiffness(handle(people_), index(22), number(1, 1e3), number(0, 1));
      default:
        return sinew_character_get_stiffness(handle(people_), index(40), or_null(&stiffness),
                                             or_null(&ratio));
    }
  }

  std::vector<char> remembered_;

 private:
  sinew_look_state look_{};
  sinew_curve_value input_{};
  sinew_feet_state feet_{};
  std::vector<float> transition_;
  const std::string graph_path_ = fixtures::sample_graph();
  std::array<std::int32_t, 3> joints_{};
};

}  // namespace sinew
