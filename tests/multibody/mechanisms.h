// Mechanisms of the tests: the own ones in assets/, and those of the paper with their references in
// ../shared.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "fixtures/paths.h"
#include "mechanism/mechanism_file.h"

namespace sinew::multibody {

inline const std::string kOwn = source_dir() + "/assets/mechanisms/";
inline const std::string kShared = shared_dir() + "/mechanisms/";

inline bool have_shared() {
  return std::filesystem::exists(kShared);
}
inline constexpr const char* kNoShared = "../shared/mechanisms is not there";

inline Mechanism loaded(const std::string& path) {
  Mechanism m;
  const std::string fault = mechanism::load_mechanism(path, m);
  EXPECT_EQ(fault, "");
  return m;
}

/// Open chains and closed ones of assets/, and of the paper when they are there.
inline std::vector<std::string> open_mechanisms() {
  std::vector<std::string> all = {kOwn + "pendulum.json", kOwn + "chain.json", kOwn + "figure1.json"};
  if (have_shared())
    for (const char* name : {"fivebar_pendulum", "fivebar_planar", "driver_nonstiff", "driver_stiff"})
      all.push_back(kShared + name + ".json");
  return all;
}
inline std::vector<std::string> closed_mechanisms() {
  std::vector<std::string> all = {kOwn + "four_bar.json", kOwn + "four_bar_rod.json"};
  if (have_shared())
    for (const char* name : {"bricard", "bricard_slender", "driver_nonstiff_hands", "driver_stiff_hands",
                             "suspension_5ps", "suspension_mfs", "slider_crank"})
      all.push_back(kShared + name + ".json");
  return all;
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
