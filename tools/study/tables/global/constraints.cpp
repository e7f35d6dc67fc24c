#include "study/tables/global/constraints.h"

namespace sinew::study {
namespace {

using multibody::BodyMotion;
using multibody::BodyPoint;
using multibody::kGround;
using Kind = BasicConstraint::Kind;
using Row = Eigen::RowVector3d;

Mat3<double> cross_matrix(const Vec3<double>& a) {
  Mat3<double> m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// A point of a body: where it is, its arm from the centre of mass, velocity, acceleration by turning alone.
struct Point {
  Vec3<double> at, arm, rate, bend;

  Point(const BodyMotion& m, const BodyPoint& p)
      : at(p.local), arm(Vec3<double>::Zero()), rate(Vec3<double>::Zero()), bend(Vec3<double>::Zero()) {
    if (p.body == kGround) return;
    at = position_of(m, p);
    arm = at - m.pose.center[p.body];
    rate = velocity_at(m, p.body, at);
    bend = m.omega[p.body].cross(m.omega[p.body].cross(arm));
  }
};

/// A direction carried by a body.
struct Direction {
  Vec3<double> is, rate, bend;

  Direction(const BodyMotion& m, int body, const Vec3<double>& local)
      : is(local), rate(Vec3<double>::Zero()), bend(Vec3<double>::Zero()) {
    if (body == kGround) return;
    is = m.pose.rotation[body] * local;
    rate = m.omega[body].cross(is);
    bend = m.omega[body].cross(rate);
  }
};

void coincide(const Point& a, const Point& b, Linearised& out) {
  out.gap = b.at - a.at;
  out.by_a.resize(3, 6);
  out.by_b.resize(3, 6);
  out.by_a << -Mat3<double>::Identity(), cross_matrix(a.arm);
  out.by_b << Mat3<double>::Identity(), -cross_matrix(b.arm);
  out.bend = b.bend - a.bend;
}

void normal(const Direction& u, const Direction& w, Linearised& out) {
  const Row turn = u.is.cross(w.is).transpose();
  out.gap = Eigen::Matrix<double, 1, 1>(u.is.dot(w.is));
  out.by_a.resize(1, 6);
  out.by_b.resize(1, 6);
  out.by_a << Row::Zero(), turn;
  out.by_b << Row::Zero(), -turn;
  out.bend = Eigen::Matrix<double, 1, 1>(u.bend.dot(w.is) + 2 * u.rate.dot(w.rate) + u.is.dot(w.bend));
}

/// `line` dotted with the change of b − a, and what turning body a adds by carrying `line` round.
void along_line(const Vec3<double>& line, const Vec3<double>& carried, const Point& a, const Point& b,
                Linearised& out) {
  out.by_a.resize(1, 6);
  out.by_b.resize(1, 6);
  out.by_a << -line.transpose(), (carried - a.arm.cross(line)).transpose();
  out.by_b << line.transpose(), b.arm.cross(line).transpose();
}

void normal_to_line(const Direction& u, const Point& a, const Point& b, Linearised& out) {
  const Vec3<double> apart = b.at - a.at, rate = b.rate - a.rate;
  out.gap = Eigen::Matrix<double, 1, 1>(u.is.dot(apart));
  along_line(u.is, u.is.cross(apart), a, b, out);
  out.bend =
      Eigen::Matrix<double, 1, 1>(u.bend.dot(apart) + 2 * u.rate.dot(rate) + u.is.dot(b.bend - a.bend));
}

void distance(double length, const Point& a, const Point& b, Linearised& out) {
  const Vec3<double> apart = b.at - a.at, rate = b.rate - a.rate;
  out.gap = Eigen::Matrix<double, 1, 1>((apart.squaredNorm() - length * length) / (2 * length));
  along_line(apart / length, Vec3<double>::Zero(), a, b, out);
  out.bend = Eigen::Matrix<double, 1, 1>((rate.squaredNorm() + apart.dot(b.bend - a.bend)) / length);
}

/// Collects constraints and counts their rows.
class Collector {
 public:
  void add(Kind kind, const BodyPoint& a, const BodyPoint& b, const Vec3<double>& along_a,
           const Vec3<double>& along_b, double length = 0) {
    all_.push_back({kind, rows_, a, b, along_a, along_b, length});
    rows_ += all_.back().rows();
  }
  void hinge(const BodyPoint& a, const BodyPoint& b, const Vec3<double>& axis) {
    const Vec3<double> none = Vec3<double>::Zero(), first = axis.unitOrthogonal();
    add(Kind::kCoincide, a, b, none, none);
    add(Kind::kNormal, a, b, first, axis);
    add(Kind::kNormal, a, b, axis.cross(first), axis);
  }
  void slider(const BodyPoint& a, const BodyPoint& b, const Vec3<double>& axis) {
    const Vec3<double> first = axis.unitOrthogonal(), second = axis.cross(first);
    add(Kind::kNormal, a, b, first, axis);
    add(Kind::kNormal, a, b, second, axis);
    add(Kind::kNormal, a, b, first, second);
    add(Kind::kNormalToLine, a, b, first, Vec3<double>::Zero());
    add(Kind::kNormalToLine, a, b, second, Vec3<double>::Zero());
  }
  std::vector<BasicConstraint> all() const { return all_; }

 private:
  std::vector<BasicConstraint> all_;
  int rows_ = 0;
};

}  // namespace

std::vector<BasicConstraint> constraints_of(const multibody::Model& model) {
  Collector collector;
  const Tree<double>& tree = model.tree;
  for (int i = 0; i < model.size(); ++i) {
    // Axes of all bodies are the world's in the assembled configuration.
    const BodyPoint on_parent{tree.parent[i], tree.rest[i].translation}, on_body{i, Vec3<double>::Zero()};
    if (tree.type[i] == JointType::kRevolute)
      collector.hinge(on_parent, on_body, tree.axis[i]);
    else
      collector.slider(on_parent, on_body, tree.axis[i]);
  }
  const Vec3<double> none = Vec3<double>::Zero();
  for (const multibody::LoopModel& l : model.loops) {
    if (l.type == multibody::LoopType::kRevolute)
      collector.hinge(l.a, l.b, l.axis_b);
    else if (l.type == multibody::LoopType::kDistance)
      collector.add(Kind::kDistance, l.a, l.b, none, none, l.length);
    else
      collector.add(Kind::kCoincide, l.a, l.b, none, none);
  }
  return collector.all();
}

Linearised linearise(const BasicConstraint& c, const BodyMotion& m) {
  Linearised out;
  switch (c.kind) {
    case Kind::kCoincide:
      coincide(Point(m, c.a), Point(m, c.b), out);
      break;
    case Kind::kNormal:
      normal(Direction(m, c.a.body, c.along_a), Direction(m, c.b.body, c.along_b), out);
      break;
    case Kind::kNormalToLine:
      normal_to_line(Direction(m, c.a.body, c.along_a), Point(m, c.a), Point(m, c.b), out);
      break;
    case Kind::kDistance:
      distance(c.length, Point(m, c.a), Point(m, c.b), out);
      break;
  }
  return out;
}

}  // namespace sinew::study
