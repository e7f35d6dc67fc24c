// Mechanisms that cannot be: each is refused with the name of the element and what is wrong with it.
#include <functional>

#include "mechanisms.h"

namespace sinew::multibody {
namespace {

using nlohmann::json;

json four_bar() {
  std::ifstream file(kOwn + "four_bar.json");
  return json::parse(file);
}

/// What is said of the four-bar after `spoil`, by the reader or at the start of the simulation.
std::string verdict(const std::function<void(json&)>& spoil) {
  json file = four_bar();
  spoil(file);
  Mechanism mechanism;
  if (const std::string fault = mechanism::from_json(file, mechanism); !fault.empty()) return fault;
  const Model model(mechanism);
  SimulationSettings settings;
  settings.t_end = 0.01;
  return simulate(model, settings).stopped;
}

void expect_said(const std::string& said, const std::string& who, const std::string& what) {
  EXPECT_NE(said.find(who), std::string::npos) << said;
  EXPECT_NE(said.find(what), std::string::npos) << said;
}

TEST(BadMechanism, TheSoundOneIsAccepted) {
  EXPECT_EQ(verdict([](json&) {}), "");
}

TEST(BadMechanism, ThatCannotBeAssembledNamesTheLoopAndItsGap) {
  const std::string said = verdict([](json& m) {
    m["joints"][0]["q0"] = 1.5;  // crank and rocker turned apart, far from where the coupler reaches both
    m["joints"][2]["q0"] = -2.5;
  });
  expect_said(said, "loop 'C'", "cannot be assembled");
  expect_said(said, "gap of", "m at the start");
}

TEST(BadMechanism, LeafWithoutMassIsNamed) {
  expect_said(verdict([](json& m) {
                m["bodies"][2]["mass"] = 0;
                m["bodies"][2]["inertia"] = {0, 0, 0, 0, 0, 0};
              }),
              "body 'rocker'", "leaf without mass");
}

TEST(BadMechanism, InertiaWithoutMassOrAgainstPhysicsIsNamed) {
  expect_said(verdict([](json& m) { m["bodies"][0]["mass"] = 0; }), "body 'crank'", "no mass");
  expect_said(verdict([](json& m) { m["bodies"][0]["mass"] = -1; }), "body 'crank'", "negative mass");
  expect_said(verdict([](json& m) { m["bodies"][0]["inertia"] = {-1, 1, 1, 0, 0, 0}; }), "body 'crank'",
              "negative principal");
  expect_said(verdict([](json& m) { m["bodies"][0]["inertia"] = {1, 1, 5, 0, 0, 0}; }), "body 'crank'",
              "triangle");
}

TEST(BadMechanism, UnknownTypesAreNamedWithTheKnownOnes) {
  expect_said(verdict([](json& m) { m["joints"][1]["type"] = "screw"; }), "joint 'B'",
              "unknown type 'screw'");
  expect_said(verdict([](json& m) { m["loops"][0]["type"] = "glue"; }), "loop 'C'", "unknown type 'glue'");
  expect_said(verdict([](json& m) {
                m["forces"] = {{{"name", "f"}, {"type", "magic"}}};
              }),
              "force 'f'", "unknown type 'magic'");
}

TEST(BadMechanism, MissingParentIsNamed) {
  expect_said(verdict([](json& m) { m["joints"][1]["parent"] = "nobody"; }), "joint 'B'", "'nobody'");
  expect_said(verdict([](json& m) { m["joints"][1].erase("parent"); }), "joint 'B'", "'parent' is missing");
  expect_said(verdict([](json& m) { m["joints"].erase(2); }), "body 'rocker'", "no joint");
}

TEST(BadMechanism, CyclesThatAreNotDeclaredAsLoopsAreNamed) {
  // Closed by a second joint on the same body, and by joints that are each other's parents.
  expect_said(verdict([](json& m) {
                json closing = m["joints"][2];
                closing["name"] = "C";
                closing["parent"] = "coupler";
                m["joints"].push_back(closing);
              }),
              "body 'rocker' is the child of two joints", "loops");
  expect_said(verdict([](json& m) {
                m["joints"][0]["parent"] = "rocker";
                m["joints"][2]["parent"] = "coupler";
              }),
              "joint 'A'", "cycle");
}

TEST(BadMechanism, OrderOfJointsIsCheckedByName) {
  expect_said(verdict([](json& m) { std::swap(m["joints"][0], m["joints"][1]); }), "joint 'B'", "before");
}

TEST(BadMechanism, InitialVelocitiesThatTearALoopApartNameIt) {
  expect_said(verdict([](json& m) { m["joints"][0]["qd0"] = 1; }), "loop 'C'", "initial velocities");
}

TEST(BadMechanism, NumbersThatAreNoneAreNamedWithTheirField) {
  expect_said(verdict([](json& m) { m["bodies"][1]["mass"] = "heavy"; }), "body 'coupler'", "'mass'");
  expect_said(verdict([](json& m) { m["bodies"][1]["com"] = {0, 1}; }), "body 'coupler'", "'com'");
  expect_said(verdict([](json& m) { m["joints"][1]["axis"] = {0, 2, 0}; }), "joint 'B'", "length 1");
  expect_said(verdict([](json& m) { m["t_end"] = -1; }), "t_end", "positive");
  expect_said(verdict([](json& m) { m["bodies"][1]["name"] = "crank"; }), "body 'crank'", "twice");
}

TEST(BadMechanism, JointThatMovesNoInertiaIsNamed) {
  expect_said(verdict([](json& m) {
                m["bodies"][2]["com"] = m["joints"][2]["anchor"];
                m["bodies"][2]["inertia"] = {0, 0, 0, 0, 0, 0};
              }),
              "joint 'D'", "moves no inertia");
}

TEST(BadMechanism, RodOfAnotherLengthIsNamed) {
  std::ifstream file(kOwn + "four_bar_rod.json");
  json mechanism_json = json::parse(file);
  mechanism_json["loops"][0]["length"] = 3.0;
  Mechanism mechanism;
  expect_said(mechanism::from_json(mechanism_json, mechanism), "loop 'coupler'", "'length'");
}

}  // namespace
}  // namespace sinew::multibody
