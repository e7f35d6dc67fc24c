#include "study/tables/global/cartesian_equations.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

namespace sinew::study {

using multibody::ConstVector;
using multibody::kGround;
using multibody::Vector;

namespace {

constexpr double kPenaltyOfMass = 1e7;  ///< α over the mean mass of what has mass; the authors' 1e7 for 1 kg
constexpr double kOmega = 10, kMu = 1;  ///< 1/s and –; the authors'
constexpr double kRedundant = 1e-9;     ///< pivot over the largest, below which an equation says nothing new
constexpr double kClosed = 1e-10;       ///< m or sine, after a projection
constexpr int kProjections = 10;        ///< at most
constexpr double kDifference = 1e-7;    ///< m, rad, m/s or rad/s by which forces are differentiated

}  // namespace

CartesianEquations::CartesianEquations(const multibody::Model& model, GlobalClosure closure)
    : model_(&model),
      closure_(closure),
      bodies_(model.size()),
      motion_(model),
      constraints_(constraints_of(model)),
      linear_(constraints_.size()),
      state_(Vector::Zero(13 * bodies_)),
      velocity_(Vector::Zero(6 * bodies_)),
      force_(Vector::Zero(6 * bodies_)) {
  for (const BasicConstraint& c : constraints_) rows_ += c.rows();
  phi_ = bend_ = Vector::Zero(rows_);
  double mass = 0;
  int massive = 0;
  for (const double m : model.tree.mass) {
    mass += m;
    massive += m > 0;
  }
  penalty_ = kPenaltyOfMass * mass / std::max(1, massive);
  for (int i = 0; i < rows_; ++i) kept_.push_back(i);
  kept_rows_ = rows_;
  find_couplings();
  const Eigen::Index unknowns = 6 * bodies_ + (closure == GlobalClosure::kMultipliers ? kept_rows_ : 0);
  mass_assembly_.resize(unknowns);
  iteration_assembly_.resize(unknowns);
}

void CartesianEquations::find_couplings() {
  std::vector<std::set<int>> near(bodies_);
  const auto join = [&](int a, int b) {
    if (a < 0 || b < 0) return;
    near[a].insert(b);
    near[b].insert(a);
  };
  for (int i = 0; i < bodies_; ++i) {
    join(i, i);
    join(i, model_->tree.parent[i]);
  }
  for (const multibody::ForceModel& f : model_->forces) join(f.a.body, f.b.body);
  for (int i = 0; i < bodies_; ++i)
    for (const int k : near[i]) couplings_.push_back({i, k});
  for (int i = 0; i < bodies_; ++i) {
    std::set<int> taken;
    for (const int k : near[i])
      for (const int other : near[k])
        if (other < i) taken.insert(colour_[other]);
    int colour = 0;
    while (taken.contains(colour)) ++colour;
    colour_.push_back(colour);
  }
}

std::string CartesianEquations::start(Vector& state) {
  multibody::Equations assembled(*model_, multibody::Formulation::kDsr, multibody::Tangent::kNumeric);
  Vector joints;
  if (std::string why = assembled.start(joints); !why.empty()) return why;
  state = state_of(joints);
  if (closure_ == GlobalClosure::kMultipliers && model_->loop_rows > 0) {
    if (!place(state)) return "the start is not finite";
    leave_out_redundant_rows();
  }
  return {};
}

void CartesianEquations::leave_out_redundant_rows() {
  multibody::Matrix columns = multibody::Matrix::Zero(6 * bodies_, rows_);
  for (int row = 0; row < rows_; ++row) {
    Vector of_row = Vector::Zero(6 * bodies_);
    add_transposed(Vector::Unit(rows_, row), of_row);
    columns.col(row) = of_row;
  }
  Eigen::ColPivHouseholderQR<multibody::Matrix> pivoted;
  pivoted.setThreshold(kRedundant);
  pivoted.compute(columns);
  kept_.assign(rows_, -1);
  for (Eigen::Index i = 0; i < pivoted.rank(); ++i) kept_[pivoted.colsPermutation().indices()[i]] = 0;
  kept_rows_ = 0;
  for (int& row : kept_)
    if (row == 0) row = kept_rows_++;
  for (SparseAssembly* assembly : {&mass_assembly_, &iteration_assembly_}) {
    assembly->forget();
    assembly->resize(6 * bodies_ + kept_rows_);
  }
  mass_analysed_ = iteration_analysed_ = false;
}

bool CartesianEquations::place(const Vector& state) {
  if (!motion_.set(state)) return false;
  state_ = state;
  velocity_ = state.tail(6 * bodies_);
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const BasicConstraint& c = constraints_[i];
    linear_[i] = linearise(c, motion_.motion());
    phi_.segment(c.first_row, c.rows()) = linear_[i].gap;
    bend_.segment(c.first_row, c.rows()) = linear_[i].bend;
  }
  return true;
}

bool CartesianEquations::prepare(double t, const Vector& state) {
  ++counts_.evaluations;
  if (!place(state)) return false;
  motion_.wrenches(t, force_);
  return true;
}

Vector CartesianEquations::joints_of(const Vector& state) {
  Vector joints(2 * bodies_);
  place(state);
  joints << motion_.joint_positions(), motion_.joint_rates();
  return joints;
}

double CartesianEquations::gap() const {
  return phi_.cwiseAbs().maxCoeff();
}

void CartesianEquations::add_mass(SparseAssembly& to, double times) const {
  for (int i = 0; i < bodies_; ++i) {
    to.add_block(6 * i, 6 * i, (times * model_->tree.mass[i] * Mat3<double>::Identity()).eval());
    to.add_block(6 * i + 3, 6 * i + 3, (times * motion_.inertia(i)).eval());
  }
}

void CartesianEquations::add_penalties(SparseAssembly& to, double times) const {
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const int a = constraints_[i].a.body, b = constraints_[i].b.body;
    const Linearised& l = linear_[i];
    const auto add = [&](int row, int column, const Linearised::Rows& left, const Linearised::Rows& right) {
      if (row != kGround && column != kGround)
        to.add_block(6 * row, 6 * column, Mat6(times * penalty_ * left.transpose() * right));
    };
    add(a, a, l.by_a, l.by_a);
    add(a, b, l.by_a, l.by_b);
    add(b, a, l.by_b, l.by_a);
    add(b, b, l.by_b, l.by_b);
  }
}

void CartesianEquations::add_constraints(SparseAssembly& to) const {
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const auto add = [&](int body, const Linearised::Rows& by) {
      if (body == kGround) return;
      for (int r = 0; r < constraints_[i].rows(); ++r) {
        const int row = kept_[constraints_[i].first_row + r];
        if (row < 0) continue;
        to.add_block(6 * bodies_ + row, 6 * body, by.row(r));
        to.add_block(6 * body, 6 * bodies_ + row, by.row(r).transpose());
      }
    };
    add(constraints_[i].a.body, linear_[i].by_a);
    add(constraints_[i].b.body, linear_[i].by_b);
  }
}

bool CartesianEquations::factorise_mass() {
  ++counts_.factorisations;
  mass_assembly_.begin();
  add_mass(mass_assembly_, 1);
  if (closure_ == GlobalClosure::kPenalty)
    add_penalties(mass_assembly_, 1);
  else
    add_constraints(mass_assembly_);
  mass_assembly_.end();
  const auto factorise = [&](auto& factor) {
    if (!mass_analysed_) factor.analyzePattern(mass_assembly_.matrix());
    mass_analysed_ = true;
    factor.factorize(mass_assembly_.matrix());
    return factor.info() == Eigen::Success;
  };
  return closure_ == GlobalClosure::kPenalty ? factorise(penalty_factor_) : factorise(multiplier_factor_);
}

Vector CartesianEquations::by_jacobian(const Vector& v) const {
  Vector out(rows_);
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const BasicConstraint& c = constraints_[i];
    Linearised::Values sum = Linearised::Values::Zero(c.rows());
    if (c.a.body != kGround) sum += linear_[i].by_a * v.segment<6>(6 * c.a.body);
    if (c.b.body != kGround) sum += linear_[i].by_b * v.segment<6>(6 * c.b.body);
    out.segment(c.first_row, c.rows()) = sum;
  }
  return out;
}

void CartesianEquations::add_transposed(const Vector& x, Vector& out) const {
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const BasicConstraint& c = constraints_[i];
    const Linearised::Values rows = x.segment(c.first_row, c.rows());
    if (c.a.body != kGround) out.segment<6>(6 * c.a.body) += linear_[i].by_a.transpose() * rows;
    if (c.b.body != kGround) out.segment<6>(6 * c.b.body) += linear_[i].by_b.transpose() * rows;
  }
}

Vector CartesianEquations::kept(const Vector& rows) const {
  Vector out(kept_rows_);
  for (int i = 0; i < rows_; ++i)
    if (kept_[i] >= 0) out[kept_[i]] = rows[i];
  return out;
}

Vector CartesianEquations::times_mass(const Vector& v) const {
  Vector out(6 * bodies_);
  for (int i = 0; i < bodies_; ++i) {
    out.segment<3>(6 * i) = model_->tree.mass[i] * v.segment<3>(6 * i);
    out.segment<3>(6 * i + 3) = motion_.inertia(i) * v.segment<3>(6 * i + 3);
  }
  return out;
}

Vector CartesianEquations::times_stiffness(const Vector& x) const {
  Vector out = Vector::Zero(6 * bodies_);
  for (const Coupling& c : couplings_) out.segment<6>(6 * c.i) += c.stiffness * x.segment<6>(6 * c.k);
  return out;
}

Vector CartesianEquations::penalty_reaction() const {
  return -penalty_ * (bend_ + 2 * kOmega * kMu * by_jacobian(velocity_) + kOmega * kOmega * phi_);
}

bool CartesianEquations::accelerations(double t, const Vector& state, Vector& a) {
  if (!prepare(t, state) || !factorise_mass()) return false;
  if (closure_ == GlobalClosure::kPenalty) {
    Vector right = force_;
    add_transposed(penalty_reaction(), right);
    a = penalty_factor_.solve(right);
  } else {
    Vector right(6 * bodies_ + kept_rows_);
    right << force_, -kept(bend_);
    a = multiplier_factor_.solve(right).head(6 * bodies_);
  }
  return a.allFinite();
}

bool CartesianEquations::derivative(double t, const Vector& y, Vector& yp) {
  Vector a;
  if (!accelerations(t, y, a)) return false;
  yp.resize(size());
  motion_.position_rates(y, velocity_, yp.head(7 * bodies_));
  yp.tail(6 * bodies_) = a;
  return true;
}

bool CartesianEquations::residual(double t, const Vector& y, const Vector& yp, Vector& r) {
  if (!derivative(t, y, r)) return false;
  r = yp - r;
  return true;
}

bool CartesianEquations::tangent(double t, const Vector& y, const Vector&, double, bool) {
  ++counts_.tangents;
  if (!prepare(t, y)) return false;
  const Vector base = force_;
  Vector moved(6 * bodies_);
  const int colours = 1 + *std::max_element(colour_.begin(), colour_.end());
  for (int colour = 0; colour < colours; ++colour)
    for (int coordinate = 0; coordinate < 12; ++coordinate) {
      const bool of_speed = coordinate >= 6;
      const int k = coordinate % 6;
      motion_.set(y);
      for (int body = 0; body < bodies_; ++body)
        if (colour_[body] == colour)
          of_speed ? motion_.speed_up(body, k, kDifference) : motion_.move(body, k, kDifference);
      motion_.refresh_joints();
      motion_.wrenches(t, moved);
      for (Coupling& c : couplings_)
        if (colour_[c.k] == colour)
          (of_speed ? c.damping : c.stiffness).col(k) = (base - moved).segment<6>(6 * c.i) / kDifference;
    }
  motion_.set(y);
  return true;
}

bool CartesianEquations::factorise(double c) {
  ++counts_.factorisations;
  c_ = c;
  if (closure_ == GlobalClosure::kPenalty) mass_then_ = mass_assembly_.matrix();
  iteration_assembly_.begin();
  add_mass(iteration_assembly_, c);
  for (const Coupling& k : couplings_)
    iteration_assembly_.add_block(6 * k.i, 6 * k.k, Mat6(k.damping + k.stiffness / c));
  if (closure_ == GlobalClosure::kPenalty)
    add_penalties(iteration_assembly_, c + 2 * kOmega * kMu + kOmega * kOmega / c);
  else
    add_constraints(iteration_assembly_);
  iteration_assembly_.end();
  if (!iteration_analysed_) iteration_factor_.analyzePattern(iteration_assembly_.matrix());
  iteration_analysed_ = true;
  iteration_factor_.factorize(iteration_assembly_.matrix());
  return iteration_factor_.info() == Eigen::Success;
}

void CartesianEquations::solve(Vector& r) {
  const Eigen::Index places = 7 * bodies_, speeds = 6 * bodies_;
  const Vector second = r.tail(speeds), turned = motion_.turns_of(state_, r.head(places));
  Vector rate;
  if (closure_ == GlobalClosure::kPenalty) {
    // αΦᵀΦ is that of the factorisation: today's would multiply by α how far Φ has turned since.
    const Vector penalised = mass_then_ * turned - times_mass(turned);
    rate = iteration_factor_.solve(
        Vector(mass_then_ * second - (times_stiffness(turned) + kOmega * kOmega * penalised) / c_));
  } else {
    Vector right(speeds + kept_rows_);
    right << times_mass(second) - times_stiffness(turned) / c_, kept(by_jacobian(second)) / c_;
    rate = iteration_factor_.solve(right).head(speeds);
  }
  Vector followed(places);
  motion_.position_rates(state_, rate, followed);
  r.head(places) = (r.head(places) + followed) / c_;
  r.tail(speeds) = rate;
}

bool CartesianEquations::accept(double, Vector& y) {
  const auto normalise = [&] {
    for (int i = 0; i < bodies_; ++i) y.segment<4>(7 * i + 3).normalize();
  };
  normalise();
  if (closure_ == GlobalClosure::kPenalty || !place(y) || !factorise_mass()) return false;
  const Eigen::Index places = 7 * bodies_, speeds = 6 * bodies_;
  const auto correction = [&](const Vector& open) {
    Vector right(speeds + kept_rows_);
    right << Vector::Zero(speeds), -kept(open);
    return Vector(multiplier_factor_.solve(right).head(speeds));
  };
  for (int i = 0; i < kProjections && kept(phi_).cwiseAbs().maxCoeff() > kClosed; ++i) {
    Vector moved(places);
    motion_.position_rates(y, correction(phi_), moved);
    y.head(places) += moved;
    normalise();
    if (!place(y)) return false;
  }
  y.tail(speeds) += correction(by_jacobian(velocity_));
  return false;
}

}  // namespace sinew::study
