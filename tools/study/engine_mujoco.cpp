// MuJoCo (Debian's libmujoco-dev) on the study's scenes. The model is written as MJCF from the same
// skeletons. Contacts and solver are MuJoCo's defaults; muscles are servos with MuJoCo's own force ranges.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "study/engine.h"

namespace sinew::study {
namespace {

constexpr double kReturnTime = 0.1;  // s, as Accuracy::return_time

struct FreeModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};
struct FreeData {
  void operator()(mjData* d) const { mj_deleteData(d); }
};

std::ostream& operator<<(std::ostream& out, const Vec3<double>& v) {
  return out << v.x() << ' ' << v.y() << ' ' << v.z();
}

std::ostream& operator<<(std::ostream& out, const Quat<double>& q) {
  return out << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z();
}

constexpr double kDrivenRoot = 1e5;  ///< a driven root weighs so many times as much: nothing moves it

void write_joint(std::ostream& xml, const Joint& joint, const std::string& name, double heavier) {
  if (joint.type == JointType::kFree) {
    xml << "<freejoint name=\"" << name << "\"/>";
  } else if (joint.type != JointType::kFixed) {
    xml << "<joint name=\"" << name << "\" type=\"" << (joint.type == JointType::kBall ? "ball" : "hinge")
        << "\" damping=\"" << joint.dofs[0].damping << "\" frictionloss=\"" << joint.dofs[0].dry_friction
        << '"';
    if (joint.type == JointType::kRevolute) xml << " axis=\"" << joint.axis << '"';
    xml << "/>";
  }
  const Mat3<double> i = heavier * joint.inertia;
  xml << "<inertial pos=\"" << joint.center_of_mass << "\" mass=\"" << heavier * joint.mass
      << "\" fullinertia=\"" << i(0, 0) << ' ' << i(1, 1) << ' ' << i(2, 2) << ' ' << i(0, 1) << ' '
      << i(0, 2) << ' ' << i(1, 2) << "\"/>";
}

/// A figure touches the floor and other figures, not itself, as ours by default.
void write_geom(std::ostream& xml, const Collider& c, int figure) {
  const bool round = c.shape == Shape::kCapsule && c.size.z() <= 0;  // refused as a capsule
  const char* kinds[] = {"sphere", "capsule", "box"};
  xml << "<geom type=\"" << (round ? "sphere" : kinds[static_cast<int>(c.shape)]) << "\" pos=\""
      << c.local.translation << "\" quat=\"" << c.local.rotation << "\" friction=\"" << c.friction
      << "\" contype=\"" << (1 << (figure + 1)) << "\" conaffinity=\"" << (0x7fffffff & ~(1 << (figure + 1)))
      << "\" size=\"";
  if (c.shape == Shape::kCapsule)
    xml << c.size.x() << ' ' << c.size.z();
  else
    xml << c.size;
  xml << "\"/>";
}

void write_bodies(std::ostream& xml, const Figure& f, int figure, int parent) {
  const Skeleton& s = f.skeleton;
  for (int i = 0; i < s.body_count; ++i) {
    const Joint& joint = s.joints[i];
    if (joint.parent != parent) continue;
    const std::string name = std::to_string(figure) + "_" + std::to_string(i);
    xml << "<body name=\"" << name << "\" pos=\"" << joint.rest.translation << "\" quat=\""
        << joint.rest.rotation << "\">";
    write_joint(xml, joint, name, f.driven && i == 0 ? kDrivenRoot : 1);
    for (const Collider& c : s.colliders)
      if (c.joint == i) write_geom(xml, c, figure);
    write_bodies(xml, f, figure, i);
    xml << "</body>";
  }
}

/// One servo per degree of freedom (not the root's); gains are set when the inertias are known.
void write_servos(std::ostream& xml, const Figure& f, int figure) {
  for (int i = 1; f.driven && i < f.skeleton.body_count; ++i)
    for (int k = 0; k < dof_count(f.skeleton.joints[i].type); ++k) {
      const DofLimits& dof = f.skeleton.joints[i].dofs[k];
      xml << "<general joint=\"" << figure << '_' << i << "\" gear=\"" << (k == 0) << ' ' << (k == 1) << ' '
          << (k == 2) << " 0 0 0\" biastype=\"affine\" forcelimited=\"true\" forcerange=\""
          << -dof.torque_minus << ' ' << dof.torque_plus << "\"/>";
    }
}

std::string mjcf(const EngineScene& scene, double h, const char* integrator) {
  std::ostringstream xml;
  xml.precision(17);
  xml << "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\" boundmass=\"1e-12\" "
         "boundinertia=\"1e-14\" "
         "balanceinertia=\"true\"/><size nconmax=\"200\" njmax=\"900\"/><option timestep=\""
      << h << "\" gravity=\"" << scene.gravity << "\" integrator=\"" << integrator
      << "\" cone=\"elliptic\"><flag energy=\"enable\"/></option><worldbody>";
  if (scene.ground)
    xml << "<geom type=\"plane\" size=\"100 100 1\" friction=\"0.8\" conaffinity=\"2147483646\"/>";
  for (std::size_t f = 0; f < scene.figures.size(); ++f)
    write_bodies(xml, scene.figures[f], static_cast<int>(f), -1);
  xml << "</worldbody><actuator>";
  for (std::size_t f = 0; f < scene.figures.size(); ++f)
    write_servos(xml, scene.figures[f], static_cast<int>(f));
  xml << "</actuator></mujoco>";
  return xml.str();
}

Vec3<double> rotation_vector(const Quat<double>& q) {
  const Eigen::AngleAxisd turn(q.w() < 0 ? Quat<double>(-q.coeffs()) : q);
  return turn.angle() * turn.axis();
}

class MujocoEngine : public Engine {
 public:
  MujocoEngine(const EngineScene& scene, double h, const char* integrator) : scene_(scene), h_(h) {
    mju_user_warning = [](const char*) {};  // else it writes MUJOCO_LOG.TXT beside the user's files
    const std::string xml = mjcf(scene, h, integrator);
    auto vfs = std::make_unique<mjVFS>();
    mj_defaultVFS(vfs.get());
    mj_makeEmptyFileVFS(vfs.get(), "scene.xml", static_cast<int>(xml.size()));
    std::copy(xml.begin(), xml.end(), static_cast<char*>(vfs->filedata[vfs->nfile - 1]));
    char why[1000] = "";
    model_.reset(mj_loadXML("scene.xml", vfs.get(), why, sizeof why));
    mj_deleteVFS(vfs.get());
    if (!model_) {
      refusal_ = why;
      return;
    }
    data_.reset(mj_makeData(model_.get()));
    for (std::size_t f = 0; f < scene.figures.size(); ++f) place(static_cast<int>(f), scene.figures[f].jets);
    mj_forward(model_.get(), data_.get());
    tune_servos();
  }

  const std::string& refusal() const override { return refusal_; }

  bool step() override {
    mj_step(model_.get(), data_.get());
    mju_zero(data_->xfrc_applied, 6 * model_->nbody);
    passes_ += data_->solver_iter;
    ++steps_;
    // On NaN MuJoCo starts again from its first pose: a failure, whatever follows.
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[warning].number > 0) return false;
    fresh_ = false;
    return true;
  }

  void aim(int figure, const std::vector<JointJet<double>>& jets) override {
    lead_root(figure, jets[0]);
    for (int k = 0; k < 3; ++k)  // what holds the root up
      data_->xfrc_applied[6 * body(figure, 0) + k] = -model_->body_mass[body(figure, 0)] * scene_.gravity[k];
    const Skeleton& s = scene_.figures[figure].skeleton;
    int actuator = first_actuator(figure);
    for (int i = 1; i < s.body_count; ++i) {
      const Quat<double> q = s.joints[i].rest.rotation.conjugate() * jets[i].rotation;
      const Vec3<double> angle = rotation_vector(q);
      const bool hinge = s.joints[i].type == JointType::kRevolute;
      for (int k = 0; k < dof_count(s.joints[i].type); ++k, ++actuator) {
        const double wanted = hinge ? angle.dot(s.joints[i].axis) : angle[k];
        const double speed = hinge ? jets[i].omega.dot(s.joints[i].axis) : jets[i].omega[k];
        data_->ctrl[actuator] = wanted + 2 * kReturnTime * speed;  // damping over stiffness, see tune_servos
      }
    }
  }

  void push(int figure, int joint, const Vec3<double>& impulse) override {
    mjtNum* wrench = data_->xfrc_applied + 6 * body(figure, joint);
    for (int k = 0; k < 3; ++k) wrench[k] += impulse[k] / h_;
  }

  double energy() const override {
    refresh();
    return data_->energy[0] + data_->energy[1];
  }

  std::vector<Transform<double>> pose(int figure) const override {
    refresh();
    std::vector<Transform<double>> out(scene_.figures[figure].skeleton.joints.size());
    for (int i = 0; i < scene_.figures[figure].skeleton.body_count; ++i) {
      const int b = body(figure, i);
      const mjtNum *x = data_->xpos + 3 * b, *q = data_->xquat + 4 * b;
      out[i].translation = {x[0], x[1], x[2]};
      out[i].rotation = Quat<double>(q[0], q[1], q[2], q[3]);
    }
    return out;
  }
  double passes() const override { return steps_ ? double(passes_) / double(steps_) : 0; }

 private:
  int body(int figure, int joint) const {
    const std::string name = std::to_string(figure) + "_" + std::to_string(joint);
    return mj_name2id(model_.get(), mjOBJ_BODY, name.c_str());
  }
  int first_actuator(int figure) const {
    int first = 0;
    for (int f = 0; f < figure; ++f)
      if (scene_.figures[f].driven)
        first +=
            scene_.figures[f].skeleton.dof_total() - dof_count(scene_.figures[f].skeleton.joints[0].type);
    return first;
  }

  /// Velocities with which a driven root is at its target after the step.
  void lead_root(int figure, const JointJet<double>& target) {
    const int joint = model_->body_jntadr[body(figure, 0)];
    const mjtNum* q = data_->qpos + model_->jnt_qposadr[joint];
    mjtNum* v = data_->qvel + model_->jnt_dofadr[joint];
    const Quat<double> now(q[3], q[4], q[5], q[6]);
    const Vec3<double> turn = rotation_vector(now.conjugate() * target.rotation);
    for (int k = 0; k < 3; ++k) v[k] = (target.translation[k] - q[k]) / h_, v[k + 3] = turn[k] / h_;
    fresh_ = false;
  }

  /// Writes the whole state.
  void place(int figure, const std::vector<JointJet<double>>& jets) {
    const Skeleton& s = scene_.figures[figure].skeleton;
    for (int i = 0; i < s.body_count; ++i) {
      const int joint = model_->body_jntadr[body(figure, i)];
      if (joint < 0) continue;
      mjtNum *q = data_->qpos + model_->jnt_qposadr[joint], *v = data_->qvel + model_->jnt_dofadr[joint];
      const Quat<double> turn = s.joints[i].rest.rotation.conjugate() * jets[i].rotation;
      if (s.joints[i].type == JointType::kRevolute) {
        q[0] = rotation_vector(turn).dot(s.joints[i].axis);
        v[0] = jets[i].omega.dot(s.joints[i].axis);
        continue;
      }
      const bool free = s.joints[i].type == JointType::kFree;
      for (int k = 0; free && k < 3; ++k) q[k] = jets[i].translation[k], v[k] = jets[i].velocity[k];
      const Quat<double>& r = free ? jets[i].rotation : turn;
      mjtNum* to = q + (free ? 3 : 0);
      to[0] = r.w(), to[1] = r.x(), to[2] = r.y(), to[3] = r.z();
      for (int k = 0; k < 3; ++k) v[k + (free ? 3 : 0)] = jets[i].omega[k];
    }
    fresh_ = false;
  }

  /// Critically damped at the time constant with which ours comes back, for the inertia about each axis. The
  /// damping is the joints', which MuJoCo's Euler and implicit integrators take implicitly.
  void tune_servos() {
    for (int a = 0; a < model_->nu; ++a) {
      int axis = 0;
      while (model_->actuator_gear[6 * a + axis] < 0.5) ++axis;
      const int dof = model_->jnt_dofadr[model_->actuator_trnid[2 * a]] + axis;
      const double inertia = data_->qM[model_->dof_Madr[dof]];
      const double stiffness = inertia / (kReturnTime * kReturnTime);
      model_->actuator_gainprm[mjNGAIN * a] = stiffness;
      model_->actuator_biasprm[mjNBIAS * a + 1] = -stiffness;
      model_->dof_damping[dof] += 2 * inertia / kReturnTime;
    }
  }

  /// Places and energies of the state after the step (mj_step leaves those before it).
  void refresh() const {
    if (fresh_) return;
    mj_fwdPosition(model_.get(), data_.get());
    mj_fwdVelocity(model_.get(), data_.get());
    mj_energyPos(model_.get(), data_.get());
    mj_energyVel(model_.get(), data_.get());
    fresh_ = true;
  }

  EngineScene scene_;
  double h_;
  std::string refusal_;
  std::unique_ptr<mjModel, FreeModel> model_;
  std::unique_ptr<mjData, FreeData> data_;
  mutable bool fresh_ = false;
  long passes_ = 0, steps_ = 0;
};

template <int which>
std::unique_ptr<Engine> make(const EngineScene& scene, double h, const Accuracy&) {
  constexpr const char* names[] = {"Euler", "implicit", "RK4"};
  return std::make_unique<MujocoEngine>(scene, h, names[which]);
}

}  // namespace

std::vector<EngineOption> mujoco_options() {
  return {{"MuJoCo", "Euler", make<0>}, {"MuJoCo", "implicit", make<1>}, {"MuJoCo", "RK4", make<2>}};
}

}  // namespace sinew::study
