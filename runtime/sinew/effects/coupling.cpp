#include "sinew/effects/coupling.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// Weights that pull a loop as far apart as it is.
constexpr double kSlack = 10;   ///< a loop that bore nothing: open by more, it began so
constexpr double kYields = 10;  ///< to a driven root
constexpr double kTorn = 200;
constexpr double kTightened = 0.5;  ///< of what is tight: so far a multiplier closes

/// Whether a multiplier pulls it besides its spring.
template <class T>
bool is_pulled(const Stencil<T>& e) {
  return e.shortened != T(0) || !e.shift.isZero(T(0));
}

template <class T>
Mat3<T> deformation(const Coupling<T>& c, const Tetrahedron<T>& e) {
  Mat3<T> f = Mat3<T>::Zero();
  // Relative to one corner: far from the common origin differences keep their digits.
  const Vec3<T>& base = c.nodes[e.node[0]].point;
  for (int i = 1; i < 4; ++i) f += (c.nodes[e.node[i]].point - base) * e.slope[i].transpose();
  return f;
}

/// J at which the volume term is at rest: α = 1 + μ/λ − μ/(4λ).
template <class T>
T rest_volume(const Tetrahedron<T>& e) {
  return T(1) + T(0.75) * e.mu / e.lame;
}

/// ∂det F/∂F: the columns' cross products.
template <class T>
Mat3<T> cofactors(const Mat3<T>& f) {
  Mat3<T> m;
  m.col(0) = f.col(1).cross(f.col(2));
  m.col(1) = f.col(2).cross(f.col(0));
  m.col(2) = f.col(0).cross(f.col(1));
  return m;
}

/// Energy density by (13) of the paper, less its value at rest, J/m³, and the stress P = ∂/∂F by (18).
template <class T>
T density(const Tetrahedron<T>& e, const Mat3<T>& f, Mat3<T>& stress) {
  const T squares = f.squaredNorm(), off = f.determinant() - rest_volume(e);
  const T rest = T(1) - rest_volume(e);
  stress = e.mu * (T(1) - T(1) / (squares + 1)) * f + e.lame * off * cofactors(f);
  const T logarithm = T(std::log(double((squares + 1) / 4)));  // in float as portable_math.h has it
  return T(0.5) * e.mu * (squares - 3 - logarithm) + T(0.5) * e.lame * (off - rest) * (off + rest);
}

/// F = U diag(σ) Vᵀ with rotations U and V: the smallest σ is negative where the element is inside out.
template <class T>
void rotation_svd(const Mat3<T>& f, Mat3<T>& u, Vec3<T>& sigma, Mat3<T>& v) {
  const Eigen::JacobiSVD<Mat3<T>> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) {  // not finite: whatever this trial is, it will be refused
    u = v = Mat3<T>::Identity();
    sigma.setZero();
    return;
  }
  u = svd.matrixU();
  v = svd.matrixV();
  sigma = svd.singularValues();
  for (Mat3<T>* r : {&u, &v})
    if (r->determinant() < T(0)) {
      r->col(2) *= T(-1);
      sigma[2] = -sigma[2];
    }
}

/// Second derivative with the stiffness along a stencil, and across it the share of that by a function of
/// what its stretch leaves. A compressed one would buckle: cut off.
template <class T, class Function>
Mat3<T> curvature_with(const Coupling<T>& c, const Stencil<T>& e, T stiffness, const Function& share) {
  if (e.length <= T(0)) return stiffness * Mat3<T>::Identity();
  const Vec3<T> s = reach(c, e) - e.offset;
  const T size = s.norm(), length = e.length - e.shortened;
  if (size <= T(0) || (e.only_pulls && size <= length)) return Mat3<T>::Zero();
  const T across = share(std::max(T(1) - length / size, T(0)));
  const Vec3<T> along = s / size;
  return stiffness * (across * Mat3<T>::Identity() + (T(1) - across) * (along * along.transpose()));
}

}  // namespace

bool set_rest_shape(const Vec3<double> corners[4], Tetrahedron<double>& out) {
  Mat3<double> edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = corners[i + 1] - corners[0];
  out.volume = edges.determinant() / 6;
  const double size = edges.norm();
  if (!(out.volume > 1e-9 * size * size * size)) return false;
  const Mat3<double> inverse = edges.inverse();
  out.slope[0].setZero();
  for (int i = 0; i < 3; ++i) {
    out.slope[i + 1] = inverse.row(i);
    out.slope[0] -= out.slope[i + 1];
  }
  return true;
}

void set_material(double young, double poisson, Tetrahedron<double>& out) {
  const double mu = young / (2 * (1 + poisson));
  const double lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  // Equation (16) of the paper: in these the small-strain law is Hooke's.
  out.mu = 4 * mu / 3;
  out.lame = lame + 5 * mu / 6;
}

template <class T>
double measure_elements(Coupling<T>& c) {
  double energy = 0, multipliers = 0;
  for (CouplingNode<T>& node : c.nodes) node.gradient.setZero();
  for (const Stencil<T>& e : c.stencils) {
    const Vec3<T> pull = stencil_pull(c, e);
    if (pull.isZero(T(0))) continue;
    const double all = double(pull.squaredNorm() / (2 * e.stiffness));
    const double stored = is_pulled(e) ? double(T(0.5) * e.stiffness * apart(c, e).squaredNorm()) : all;
    energy += stored;
    multipliers += all - stored;
    for (int i = 0; i < e.count; ++i) c.nodes[e.node[i]].gradient += e.weight[i] * pull;
  }
  for (const Tetrahedron<T>& e : c.tetrahedra) {
    Mat3<T> stress;
    energy += double(e.volume * density(e, deformation(c, e), stress));
    for (int i = 0; i < 4; ++i) c.nodes[e.node[i]].gradient += e.volume * (stress * e.slope[i]);
  }
  c.energy = energy;
  return energy + multipliers;
}

template <class T>
Mat3<T> stencil_curvature(const Coupling<T>& c, const Stencil<T>& e) {
  return curvature_with(c, e, e.stiffness, [](T share) { return share; });
}

template <class T>
Mat3<T> stencil_root(const Coupling<T>& c, const Stencil<T>& e) {
  return curvature_with(c, e, std::sqrt(e.stiffness), [](T share) { return std::sqrt(share); });
}

template <class T>
TetrahedronHessian<T> tetrahedron_curvature(const Coupling<T>& c, const Tetrahedron<T>& e) {
  Mat3<T> u, v;
  Vec3<T> sigma;
  rotation_svd(deformation(c, e), u, sigma, v);
  const T squares = sigma.squaredNorm(), off = sigma.prod() - rest_volume(e);
  const T shear = e.mu * (T(1) - T(1) / (squares + 1));
  const Vec3<T> others(sigma[1] * sigma[2], sigma[0] * sigma[2], sigma[0] * sigma[1]);
  // Stretches along the principal axes couple with each other …
  Mat3<T> stretch = (2 * e.mu / ((squares + 1) * (squares + 1))) * (sigma * sigma.transpose()) +
                    e.lame * (others * others.transpose());
  // … and in each plane one turn and one shear stand alone: half of their sum and difference.
  Mat3<T> same = Mat3<T>::Zero(), crossed = Mat3<T>::Zero();
  for (int a = 0; a < 3; ++a) {
    stretch(a, a) += shear;
    for (int b = 0; b < 3; ++b) {
      if (a == b) continue;
      const T third = e.lame * off * sigma[3 - a - b];
      stretch(a, b) += third;
      const T turn = std::max(shear + third, T(0)), flip = std::max(shear - third, T(0));
      same(a, b) = T(0.5) * (turn + flip);
      crossed(a, b) = T(0.5) * (flip - turn);
    }
  }
  Eigen::SelfAdjointEigenSolver<Mat3<T>> modes(stretch);
  stretch = modes.eigenvectors() * modes.eigenvalues().cwiseMax(T(0)).asDiagonal() *
            modes.eigenvectors().transpose();
  Vec3<T> slope[4];
  for (int i = 0; i < 4; ++i) slope[i] = v.transpose() * e.slope[i];
  TetrahedronHessian<T> out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j <= i; ++j) {
      Mat3<T> block;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          block(a, b) = stretch(a, b) * slope[i][a] * slope[j][b];
          if (a != b) block(a, b) += crossed(a, b) * slope[i][b] * slope[j][a];
        }
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          if (a != b) block(a, a) += same(a, b) * slope[i][b] * slope[j][b];
      const Mat3<T> turned = e.volume * (u * block * u.transpose());
      out.template block<3, 3>(3 * i, 3 * j) = turned;
      out.template block<3, 3>(3 * j, 3 * i) = turned.transpose();
    }
  return out;
}

template <class T>
void close_slowly(T h, Coupling<T>& c) {
  if (!c.closes_slowly) return;
  c.driven = c.closes();
  T share = T(1);  // that closes of what is open, of all alike: else no rigid body has points at all of them
  for (Stencil<T>& e : c.stencils) {
    e.offset_before = e.offset;
    e.carried_before = e.carried;
    const Vec3<T> open = reach(c, e);
    const T torn = e.carried.last.isZero(T(0)) ? T(kSlack) : T(kTorn);
    if ((open - e.offset).norm() > e.length + torn * e.sinks)
      e.offset = open * (T(1) - e.length / open.norm());
    const Vec3<T> reached = open - e.offset;
    const T size = reached.norm(), room = e.length + T(kYields) * e.sinks - size;
    if (c.strained && room < T(0)) e.offset -= room / size * reached;
    e.unclosed_offset = e.offset;
    const T left = e.offset.norm();
    e.yields = c.strained && left > T(0);
    T closes = T(kClosingSpeed) * c.speed_scale * h;
    if (e.yields) closes = std::clamp(room, T(0), closes);
    if (left > closes) share = std::min(share, closes / left);
  }
  for (Stencil<T>& e : c.stencils) e.offset *= T(1) - share;
  c.driven = c.driven || c.closes();
}

template <class T>
bool tighten(Coupling<T>& c) {
  if (!c.closes_slowly || c.strained) return false;  // a driven root pulls with any force
  bool any = false;
  for (Stencil<T>& e : c.stencils) {
    if (!(e.tight > T(0)) || e.yields || !e.offset.isZero(T(0))) continue;
    const Vec3<T> by = apart(c, e);
    const T size = by.norm();
    if (!(size > e.tight)) continue;
    any = true;
    const T more = size - T(kTightened) * e.tight;
    if (e.length > T(0))
      e.shortened += reach(c, e).norm() > e.length ? more : -more;
    else
      e.shift += more / size * by;
  }
  return any;
}

SINEW_COUPLING_INSTANCES(template, float)
SINEW_COUPLING_INSTANCES(template, double)

}  // namespace sinew
