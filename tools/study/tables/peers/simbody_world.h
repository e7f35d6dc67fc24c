// Figures simulated by Simbody, plain data in and out: the other side of engine_simbody.cpp in the module
// that simbody_run.h tells of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sinew/skeleton/joint_type.h"
#include "sinew/skeleton/vector.h"

namespace sinew::study {

/// Its integrators; the first three and the fourth also in steps of given size.
enum class SimbodyIntegrator {
  kSemiExplicitEuler,
  kRungeKutta3,
  kRungeKuttaMerson,
  kSemiExplicitEuler2,
  kCPodes
};

struct SimbodyPlace {
  Quat<double> rotation = Quat<double>::Identity();
  Vec3<double> translation = Vec3<double>::Zero();  ///< m
};

/// JointJet: rates in child axes, translations of a free root in world axes.
struct SimbodyJet {
  SimbodyPlace place;
  Vec3<double> omega = Vec3<double>::Zero(), alpha = Vec3<double>::Zero();            ///< rad/s, rad/s²
  Vec3<double> velocity = Vec3<double>::Zero(), acceleration = Vec3<double>::Zero();  ///< m/s, m/s²
};

/// A body and the joint above it, as the skeleton's Joint.
struct SimbodyBody {
  int parent = -1;
  JointType type = JointType::kFixed;  ///< fixed, revolute, ball or free
  SimbodyPlace rest;
  Vec3<double> axis = Vec3<double>::UnitZ();
  double mass = 0;  ///< kg
  Vec3<double> center_of_mass = Vec3<double>::Zero();
  Mat3<double> inertia = Mat3<double>::Zero();  ///< about the centre of mass, kg·m²
  Vec3<double> torque_minus = Vec3<double>::Zero(), torque_plus = Vec3<double>::Zero();  ///< of muscles, N·m
  SimbodyJet start;
};

struct SimbodyShape {
  int body = 0;
  bool box = false;  ///< else a sphere
  SimbodyPlace at;
  Vec3<double> size = Vec3<double>::Zero();  ///< m: x = radius, or half extents
  double friction = 0;
};

struct SimbodyFigure {
  std::vector<SimbodyBody> bodies;  ///< parents first
  std::vector<SimbodyShape> shapes;
  bool driven = false;  ///< muscles follow `aim`, the root too
};

struct SimbodyScene {
  std::vector<SimbodyFigure> figures;
  Vec3<double> gravity = Vec3<double>::Zero();
  bool ground = false;
  SimbodyIntegrator integrator = SimbodyIntegrator::kRungeKuttaMerson;
  double step = 0;        ///< s
  double accuracy = 0;    ///< of the integrator, which cuts steps as it needs to; 0: steps of `step`
  double sink_depth = 0;  ///< m, see Accuracy; as the next two
  double stick_speed = 0, return_time = 0;
};

class SimbodyWorld {
 public:
  virtual ~SimbodyWorld() = default;
  /// As Engine's.
  virtual bool step() = 0;
  virtual void aim(int figure, const std::vector<SimbodyJet>& jets) = 0;
  virtual void push(int figure, int body, const Vec3<double>& impulse) = 0;
  virtual double energy() const = 0;
  virtual std::vector<SimbodyPlace> pose(int figure) const = 0;
  virtual Vec3<double> angular_momentum() const = 0;  ///< of all, about the common centre of mass
};

}  // namespace sinew::study

/// nullptr and why where the scene cannot be built.
extern "C" sinew::study::SimbodyWorld* sinew_simbody_world(const sinew::study::SimbodyScene& scene,
                                                           std::string& fault);
