// CharacterReport for the C interface.
#pragma once

#include "sinew/c/sinew.h"
#include "sinew/character/world.h"

namespace sinew::c {

/// All but size, on_animation and position.
inline void fill_report(const CharacterReport& r, sinew_character_report& out) {
  out.level = static_cast<sinew_level>(r.level);
  out.dofs = r.dofs;
  out.unknown_dofs = r.unknown_dofs;
  out.baked = r.baked;
  out.unbaked = r.unbaked;
  out.outer_passes = r.outer_passes;
  out.factorisations = r.factorisations;
  out.simplified_steps = r.simplified_steps;
  out.corrections = r.corrections;
  out.plain_passes = r.plain_passes;
  out.contacts = r.contacts;
  out.left_out = r.left_out;
  out.substeps = r.substeps;
  out.splits = r.splits;
  out.restarts = r.restarts;
  out.damped = r.damped;
  out.frozen = r.frozen;
  out.crowded = r.crowded;
  out.converged = r.converged;
  out.carried = r.carried;
  out.kinetic_energy = r.kinetic_energy;
  out.potential_energy = r.potential_energy;
  out.elastic_energy = r.elastic_energy;
  out.ground_force = r.ground.force;
  out.ground_turn_rate = r.ground.turn_rate;
  for (int k = 0; k < 3; ++k) {
    out.ground_place[k] = r.ground.place[k];
    out.ground_velocity[k] = r.ground.velocity[k];
    out.momentum[k] = r.momentum[k];
    out.angular_momentum[k] = r.angular_momentum[k];
  }
  out.penetration = r.penetration;
  out.help_force = r.help_force;
  out.help_torque = r.help_torque;
  out.estimated_error = r.estimated_error;
}

}  // namespace sinew::c
