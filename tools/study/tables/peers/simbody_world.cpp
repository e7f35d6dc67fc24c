#include "study/tables/peers/simbody_world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/tables/peers/simbody_muscle.h"

namespace sinew::study {
namespace {

using SimTK::MobilizedBody;

/// e = 1 − c·v of Hunt and Crossley: nothing bounces that comes at a metre per second.
constexpr double kDissipation = 1;  // s/m
constexpr double kLayer = 0.01;     // m, of the elastic foundation; only stiffness over thickness counts
constexpr double kRigid = 1e6;      // the floor's stiffness over what touches it
constexpr double kFloorFriction = 0.8;
constexpr int kExtraVertices = 2;  // on the longest edge of a box that is a mesh

SimTK::Transform simtk(const SimbodyPlace& p) {
  return {study::simtk(p.rotation), study::simtk(p.translation)};
}
SimbodyPlace place(const SimTK::Transform& t) {
  const SimTK::Quaternion q = t.R().convertRotationToQuaternion();
  return {Quat<double>(q[0], q[1], q[2], q[3]), {t.p()[0], t.p()[1], t.p()[2]}};
}

std::unique_ptr<SimTK::Integrator> integrator_of(SimbodyIntegrator kind, const SimTK::System& system) {
  switch (kind) {
    case SimbodyIntegrator::kSemiExplicitEuler:
      return std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system, 1);  // its step is set below
    case SimbodyIntegrator::kRungeKutta3:
      return std::make_unique<SimTK::RungeKutta3Integrator>(system);
    case SimbodyIntegrator::kSemiExplicitEuler2:
      return std::make_unique<SimTK::SemiExplicitEuler2Integrator>(system);
    case SimbodyIntegrator::kCPodes:
      return std::make_unique<SimTK::CPodesIntegrator>(system);
    case SimbodyIntegrator::kRungeKuttaMerson:
      break;
  }
  return std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system);
}

class World : public SimbodyWorld {
 public:
  explicit World(const SimbodyScene& scene)
      : scene_(scene),
        matter_(system_),
        forces_(system_),
        gravity_(forces_, matter_, study::simtk(scene.gravity)),
        tracker_(system_),
        contacts_(system_, tracker_),
        driven_{&scene_, &matter_, &gravity_, &tracker_, &contacts_, {}, {}, {}} {
    system_.setUseUniformBackground(true);
    contacts_.setTransitionVelocity(scene.stick_speed);
    for (const SimbodyFigure& f : scene_.figures) {
      double mass = 0;
      for (const SimbodyBody& b : f.bodies) mass += b.mass;
      weight_ = std::max(weight_, mass * std::max(1.0, scene.gravity.norm()));
    }
    if (scene.ground) add_ground();
    for (std::size_t f = 0; f < scene_.figures.size(); ++f) add(static_cast<int>(f));
    const SimTK::Force::Custom muscles(forces_,
                                       new SimbodyMuscles(driven_));  // the subsystem takes ownership
    start();
  }

  bool step() override try {
    const double begin = integrator_->getAdvancedTime();
    ++steps_;
    const bool changed = pushed_ || aimed_;
    if (changed || pushed_before_) {
      integrator_->updAdvancedState().invalidateAllCacheAtOrAbove(SimTK::Stage::Time);
      integrator_->reinitialize(SimTK::Stage::Time, false);
    }
    if (scene_.accuracy > 0) {
      // What is told for this step alone must not be looked through by a step that goes beyond it.
      const double end = static_cast<double>(steps_) * scene_.step;
      while (integrator_->getTime() < end) changed ? integrator_->stepTo(end, end) : integrator_->stepTo(end);
    } else {
      while (integrator_->getAdvancedTime() < begin + 0.5 * scene_.step) integrator_->stepTo(SimTK::Infinity);
    }
    if (pushed_) driven_.pushes.setToZero();
    pushed_before_ = pushed_;
    pushed_ = aimed_ = false;
    return std::isfinite(energy());
  } catch (const std::exception&) {
    return false;
  }

  void aim(int figure, const std::vector<SimbodyJet>& jets) override {
    driven_.targets[figure] = {jets, static_cast<double>(steps_ + 1) * scene_.step};
    aimed_ = true;
  }

  void push(int figure, int body, const Vec3<double>& impulse) override {
    const MobilizedBody& on = driven_.bodies[figure][body];
    const SimTK::Vec3 force = study::simtk(Vec3<double>(impulse / scene_.step)),
                      arm = on.expressVectorInGroundFrame(
                          state(), study::simtk(scene_.figures[figure].bodies[body].center_of_mass));
    driven_.pushes[on.getMobilizedBodyIndex()] += SimTK::SpatialVec(arm % force, force);
    pushed_ = true;
  }

  double energy() const override try {
    system_.realize(state(), SimTK::Stage::Dynamics);
    return system_.calcEnergy(state());
  } catch (const std::exception&) {  // it throws again after a step in which it threw
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::vector<SimbodyPlace> pose(int figure) const override {
    std::vector<SimbodyPlace> out;
    for (const MobilizedBody& body : driven_.bodies[figure])
      out.push_back(place(body.getBodyTransform(state())));
    return out;
  }

  Vec3<double> angular_momentum() const override {
    const SimTK::Vec3 l = matter_.calcSystemCentralMomentum(state())[0];
    return {l[0], l[1], l[2]};
  }

 private:
  const SimTK::State& state() const { return integrator_->getState(); }

  /// A point of a sphere sinks as deep under the weight of the heaviest figure as ours: Hertz,
  /// 4/3·E·√R·x^1.5.
  SimTK::ContactMaterial sphere_material(double radius, double friction) const {
    const double modulus = weight_ / (4.0 / 3 * std::sqrt(radius) * std::pow(scene_.sink_depth, 1.5));
    return {modulus, kDissipation, friction, friction};
  }
  /// A corner of a box does.
  SimTK::ContactMaterial box_material(double friction) const {
    return {weight_ / scene_.sink_depth, kDissipation, friction, friction};
  }
  /// Where boxes meet they are meshes on elastic foundations: a face sinks as deep as four corners.
  SimTK::ContactMaterial mesh_material(const Vec3<double>& half, double friction) const {
    const double face = 4 * half.x() * half.y();
    return {4 * weight_ / scene_.sink_depth * kLayer / face, kDissipation, friction, friction};
  }

  void add_ground() {
    const SimTK::ContactMaterial material(kRigid * weight_ / scene_.sink_depth, kDissipation, kFloorFriction,
                                          kFloorFriction);
    // Simbody's half space fills +x.
    matter_.updGround().updBody().addContactSurface(
        SimTK::Transform(SimTK::Rotation(SimTK::Pi / 2, SimTK::YAxis)),
        SimTK::ContactSurface(SimTK::ContactGeometry::HalfSpace(), material, kLayer));
  }

  void add_shape(SimTK::Body& body, const SimbodyShape& shape, SimTK::ContactCliqueId figure) const {
    const SimTK::Vec3 size = study::simtk(shape.size);
    const bool meshes = scene_.figures.size() > 1;  // there is no tracker of bricks on bricks
    const auto surface = [&] {
      if (!shape.box)
        return SimTK::ContactSurface(SimTK::ContactGeometry::Sphere(size[0]),
                                     sphere_material(size[0], shape.friction), kLayer);
      if (meshes)
        return SimTK::ContactSurface(
            SimTK::ContactGeometry::TriangleMesh(SimTK::PolygonalMesh::createBrickMesh(size, kExtraVertices)),
            mesh_material(shape.size, shape.friction), kLayer);
      return SimTK::ContactSurface(SimTK::ContactGeometry::Brick(size), box_material(shape.friction), kLayer);
    };
    body.addContactSurface(simtk(shape.at), surface().joinClique(figure));
  }

  void add(int f) {
    const SimbodyFigure& figure = scene_.figures[f];
    const SimTK::ContactCliqueId clique = SimTK::ContactSurface::createNewContactClique();
    std::vector<MobilizedBody>& bodies = driven_.bodies.emplace_back();
    SimbodyTarget& target = driven_.targets.emplace_back();
    for (std::size_t i = 0; i < figure.bodies.size(); ++i) {
      const SimbodyBody& b = figure.bodies[i];
      target.jets.push_back(b.start);
      const SimTK::Vec3 center = study::simtk(b.center_of_mass);
      const SimTK::Inertia central(b.inertia(0, 0), b.inertia(1, 1), b.inertia(2, 2), b.inertia(0, 1),
                                   b.inertia(0, 2), b.inertia(1, 2));
      SimTK::Body::Rigid body(
          SimTK::MassProperties(b.mass, center, central.shiftFromMassCenter(center, b.mass)));
      for (const SimbodyShape& shape : figure.shapes)
        if (scene_.ground && shape.body == static_cast<int>(i)) add_shape(body, shape, clique);
      MobilizedBody& parent =
          b.parent < 0 ? static_cast<MobilizedBody&>(matter_.updGround()) : bodies[b.parent];
      bodies.push_back(hang(parent, b, body));
    }
    if (figure.driven) const SimTK::Motion::Custom root(bodies[0], new SimbodyRoot(driven_, f));
  }

  static MobilizedBody hang(MobilizedBody& parent, const SimbodyBody& b, const SimTK::Body& body) {
    const SimTK::Transform rest = simtk(b.rest);
    switch (b.type) {
      case JointType::kFree:
        return MobilizedBody::Free(parent, body);
      case JointType::kBall:
        return MobilizedBody::Ball(parent, rest, body, SimTK::Transform());
      case JointType::kRevolute: {
        const SimTK::Transform axis(SimTK::Rotation(SimTK::UnitVec3(study::simtk(b.axis)), SimTK::ZAxis));
        return MobilizedBody::Pin(parent, rest * axis, body, axis);
      }
      default:
        return MobilizedBody::Weld(parent, rest, body, SimTK::Transform());
    }
  }

  void start() {
    SimTK::State state = system_.realizeTopology();
    driven_.pushes.resize(matter_.getNumBodies());
    driven_.pushes.setToZero();
    system_.realizeModel(state);
    for (std::size_t f = 0; f < scene_.figures.size(); ++f)
      for (std::size_t i = 0; i < scene_.figures[f].bodies.size(); ++i)
        set_start(state, driven_.bodies[f][i], scene_.figures[f].bodies[i]);
    integrator_ = integrator_of(scene_.integrator, system_);
    if (scene_.accuracy > 0) {
      integrator_->setAccuracy(scene_.accuracy);
    } else {
      integrator_->setFixedStepSize(scene_.step);
      integrator_->setReturnEveryInternalStep(true);
    }
    integrator_->initialize(state);
  }

  static void set_start(SimTK::State& state, const MobilizedBody& body, const SimbodyBody& b) {
    const SimbodyJet& jet = b.start;
    const Quat<double> turn = b.rest.rotation.conjugate() * jet.place.rotation;
    if (b.type == JointType::kFree) {
      body.setQToFitTransform(state, simtk(jet.place));
      body.setUToFitVelocity(
          state, {study::simtk(Vec3<double>(jet.place.rotation * jet.omega)), study::simtk(jet.velocity)});
    } else if (b.type == JointType::kBall) {
      body.setQToFitRotation(state, study::simtk(turn));
      body.setUToFitAngularVelocity(state, study::simtk(Vec3<double>(turn * jet.omega)));
    } else if (b.type == JointType::kRevolute) {
      body.setOneQ(state, 0, 2 * std::atan2(turn.vec().dot(b.axis), turn.w()));
      body.setOneU(state, 0, jet.omega.dot(b.axis));
    }
  }

  const SimbodyScene scene_;
  double weight_ = 0;  ///< N, of the heaviest figure
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::Gravity gravity_;
  SimTK::ContactTrackerSubsystem tracker_;
  SimTK::CompliantContactSubsystem contacts_;
  SimbodyDriven driven_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  long steps_ = 0;
  bool aimed_ = false, pushed_ = false, pushed_before_ = false;
};

}  // namespace
}  // namespace sinew::study

sinew::study::SimbodyWorld* sinew_simbody_world(const sinew::study::SimbodyScene& scene, std::string& fault) {
  try {
    return new sinew::study::World(scene);
  } catch (const std::exception& e) {
    fault = e.what();
    return nullptr;
  }
}
