// Mechanisms of the tests: small ones made for them, and those of the paper with their reference
// trajectories.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fixtures/paths.h"
#include "mechanism/mechanism_file.h"

namespace sinew::multibody {

inline const std::string kOwn = source_dir() + "/assets/mechanisms/";
inline Mechanism loaded(const std::string& path) {
  Mechanism m;
  const std::string fault = mechanism::load_mechanism(path, m);
  EXPECT_EQ(fault, "");
  return m;
}

inline std::vector<std::string> paths_of(std::initializer_list<const char*> names) {
  std::vector<std::string> all;
  for (const char* name : names) all.push_back(kOwn + name + ".json");
  return all;
}
inline std::vector<std::string> open_mechanisms() {
  return paths_of({"pendulum", "chain", "figure1", "fivebar_pendulum", "fivebar_planar", "driver_nonstiff",
                   "driver_stiff"});
}
inline std::vector<std::string> closed_mechanisms() {
  return paths_of({"four_bar", "four_bar_rod", "bricard", "bricard_slender", "driver_nonstiff_hands",
                   "driver_stiff_hands", "suspension_5ps", "suspension_mfs", "slider_crank", "andrews",
                   "governor"});
}

/// The start of the mechanism with every coordinate and rate moved by a normal deviate of that size.
inline Vector disturbed_start(Equations& equations, double size, std::mt19937& random) {
  Vector y;
  EXPECT_EQ(equations.start(y), "");
  std::normal_distribution<double> normal(0, size);
  for (double& x : y) x += normal(random);
  return y;
}

/// A serial chain of `links` rods of 0.1 m, hinges alternately about x and y.
inline Mechanism serial_chain(int links) {
  Mechanism m;
  m.name = "serial chain";
  for (int i = 0; i < links; ++i) {
    Body body;
    body.name = "link" + std::to_string(i);
    body.mass = 0.1;
    body.center_of_mass = Vec3<double>(0, 0, -0.1 * i - 0.05);
    body.inertia = Vec3<double>(1e-4, 1e-4, 1e-5).asDiagonal();
    HingeOrSlider joint;
    joint.name = "hinge" + std::to_string(i);
    joint.parent = i == 0 ? kGround : i - 1;
    joint.child = i;
    joint.anchor = Vec3<double>(0, 0, -0.1 * i);
    joint.axis = i % 2 == 0 ? Vec3<double>::UnitX() : Vec3<double>::UnitY();
    m.bodies.push_back(body);
    m.joints.push_back(joint);
  }
  return m;
}

}  // namespace sinew::multibody
