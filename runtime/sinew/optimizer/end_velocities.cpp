#include "sinew/optimizer/end_velocities.h"

#include <algorithm>
#include <limits>

#include "sinew/optimizer/bossak.h"

namespace sinew {
namespace {

constexpr int kSweeps = 30;
constexpr double kUsed = 0.98;     ///< of friction: all
constexpr double kStill = 1e-4;    ///< m/s: what slides as slowly is held by the next step's friction
constexpr double kLeft = 1e-5;     ///< m/s, rad/s: of what closes
constexpr int kStrikes = 32;       ///< in a step; more are left to the solve
constexpr double kTouches = 1e-6;  ///< m of a human

/// Of as many entries as a has.
template <class T>
T dot(std::span<const T> a, std::span<const T> b) {
  using Entries = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  const Eigen::Map<const Entries> x(a.data(), std::ssize(a)), y(b.data(), std::ssize(a));
  return x.dot(y);
}

/// The mass matrix over some degrees of freedom, as if every other joint were locked.
template <class T>
void factorise_masses(TreeProblem<T>& p, std::span<const int> dofs, ArticulatedParts<T>& out) {
  const Tree<T>& tree = *p.tree;
  for (int i = 0; i < tree.bodies; ++i) {
    const Mat3<T> turned = p.kinematics.rotation[i].lazyProduct(tree.inertia[i]);
    p.composite[i] = {};
    p.composite[i].add_body(tree.mass[i], p.kinematics.center[i],
                            turned.lazyProduct(p.kinematics.rotation[i].transpose()));
  }
  assemble_joints<T>(tree, p.kinematics, p.composite, dofs, false, out);
  std::copy_n(out.own.begin(), dofs.size(), out.factor.begin());
  (void)factorise_joints<T>(out);  // the floor sees to it
}

}  // namespace

template <class T>
void EndVelocities<T>::reserve(const SolveCapacity& capacity) {
  parts_.reserve(capacity.trees);
  for (auto* v : {&of_dof_, &dof_, &first_}) v->resize(capacity.dofs);
  blocks_.resize(capacity.bodies);
  eliminated_.resize(capacity.bodies);
  for (auto* v : {&force_, &motion_}) v->resize(capacity.bodies);
  for (auto* v : {&axes_, &moved_, &reduced_}) v->resize(capacity.dofs);
  for (auto* v : {&own_, &factor_}) v->resize(capacity.dofs);
  for (auto* v : {&rates_, &near_, &projection_}) v->resize(capacity.dofs);
  for (auto* v : {&driven_, &twist_}) v->resize(capacity.bodies);
  pressed_.reserve(kMost);
  rows_.reserve(kMost * capacity.dofs);
  row_.reserve(capacity.dofs);
  on_path_.reserve(capacity.bodies);
  for (auto* v : {&done_, &late_, &before_}) v->resize(capacity.dofs);
  disturbed_.reserve(capacity.trees);
}

template <class T>
std::size_t EndVelocities<T>::bytes(const SolveCapacity& capacity) {
  return capacity.trees * sizeof(Part) + ArticulatedMatrix<T>::bytes(capacity.bodies, capacity.dofs) +
         capacity.dofs * (7 * sizeof(T) + 7 * sizeof(int)) + 2 * capacity.bodies * sizeof(Twist<T>) +
         kMost * (sizeof(Row) + sizeof(T) * capacity.dofs);
}

template <class T>
void EndVelocities<T>::begin(std::span<TreeProblem<T>* const> problems, std::span<const std::uint8_t> loose) {
  problems_ = problems;
  parts_.clear();
  pressed_.clear();
  rows_.clear();
  Part next;
  for (TreeProblem<T>* problem : problems) {
    const Tree<T>& tree = *problem->tree;
    next.count = 0;
    for (int dof = 0; dof < tree.dofs; ++dof) {
      of_dof_[next.first_dof + dof] = -1;
      if (!loose[next.first_dof + dof]) continue;
      dof_[next.first + next.count] = dof;
      of_dof_[next.first_dof + dof] = next.count++;
    }
    const auto bodies = [&](auto& all) { return std::span(all).subspan(next.first_body, tree.bodies); };
    const auto unknowns = [&](auto& all) { return std::span(all).subspan(next.first, next.count); };
    next.matrix = {0,
                   bodies(blocks_),
                   unknowns(first_),
                   unknowns(axes_),
                   unknowns(moved_),
                   unknowns(reduced_),
                   unknowns(own_),
                   unknowns(factor_),
                   bodies(eliminated_),
                   bodies(force_),
                   bodies(motion_)};
    if (next.count > 0) {
      factorise_masses<T>(*problem, unknowns(dof_), next.matrix);
    } else {
      next.matrix.bodies = tree.bodies;
      for (int i = 0; i < tree.bodies; ++i) next.matrix.blocks[i] = {tree.parent[i], 0, 0, false};
    }
    parts_.push_back(next);
    next.first_body += tree.bodies;
    next.first_dof += tree.dofs;
    next.first += next.count;
  }
}

/// Twists of a tree's bodies: what leads joints and the motion of the unknowns at their rates.
template <class T>
void EndVelocities<T>::move(int n) {
  const Part& part = parts_[n];
  const Tree<T>& tree = *problems_[n]->tree;
  const Kinematics<T>& k = problems_[n]->kinematics;
  Twist<T>* const twists = twist_.data() + part.first_body;
  const Twist<T>* const driven = driven_.data() + part.first_body;
  for (int i = 0; i < tree.bodies; ++i) {
    Twist<T>& twist = twists[i];
    twist = driven[i];
    if (const int parent = tree.parent[i]; parent >= 0) {
      twist.w += twists[parent].w;
      twist.v += twists[parent].v;
    }
    for (int dof = tree.first_dof[i]; dof < tree.first_dof[i + 1]; ++dof) {
      const int unknown = of_dof_[part.first_dof + dof];
      if (unknown < 0) continue;
      const T rate = rates_[part.first + unknown];
      twist.w += rate * k.w[dof];
      twist.v += rate * k.v[dof];
    }
  }
}

template <class T>
void EndVelocities<T>::respond(int n, std::span<const T> force, std::span<Vec3<T>> moved,
                               std::span<Vec3<T>> turned) {
  const Part& part = parts_[n];
  const int bodies = problems_[n]->tree->bodies;
  for (int u = 0; u < part.count; ++u) rates(n)[u] = force[dof_[part.first + u]];
  solve_by_joints<T>(part.matrix, rates(n));
  std::fill_n(driven_.begin() + part.first_body, bodies, Twist<T>());
  move(n);
  for (int i = 0; i < bodies; ++i) {
    const Twist<T>& twist = twist_[part.first_body + i];
    turned[i] = twist.w;
    moved[i] = twist.at(problems_[n]->kinematics.center[i]);
  }
}

template <class T>
void EndVelocities<T>::remove_floor_share(int n, std::span<T> force, T answered) {
  const Part& part = parts_[n];
  const TreeProblem<T>& p = *problems_[n];
  const bool anew = answered == T(0);
  if (anew) {
    for (int u = 0; u < part.count; ++u) rates(n)[u] = force[dof_[part.first + u]];
    solve_by_joints<T>(part.matrix, rates(n));
  }
  for (int u = 0; u < part.count; ++u) {
    const int dof = dof_[part.first + u];
    const Composite<T>& subtree = p.composite[p.tree->dof_body[dof]];
    const T rate = anew ? rates(n)[u] : answered * rates(n)[u];
    force[dof] -= joint_floor<T>(subtree, p.kinematics.w[dof], p.kinematics.v[dof]) * rate;
  }
}

/// Rates of joint offsets as those of the unknowns: a free joint's offsets turn about the child's axes, its
/// degrees of freedom about the parent's.
template <class T>
void EndVelocities<T>::read_near(int n, std::span<const std::array<T, 6>> rate) {
  const Part& part = parts_[n];
  const Tree<T>& tree = *problems_[n]->tree;
  for (int u = 0; u < part.count; ++u) {
    const int dof = dof_[part.first + u], body = tree.dof_body[dof], k = dof - tree.first_dof[body];
    const std::array<T, 6>& r = rate[body];
    near_[part.first + u] = tree.type[body] == JointType::kFree && k >= 3
                                ? (problems_[n]->local[body].rotation * Vec3<T>(r[3], r[4], r[5]))[k - 3]
                                : r[k];
  }
}

template <class T>
void EndVelocities<T>::project(int n, std::span<const Twist<T>> driven,
                               std::span<const std::array<T, 6>> rate, std::span<const T> impulse,
                               const History<T>& history) {
  const Part& part = parts_[n];
  TreeProblem<T>& p = *problems_[n];
  const Tree<T>& tree = *p.tree;
  const Kinematics<T>& k = p.kinematics;
  std::copy_n(driven.begin(), tree.bodies, driven_.begin() + part.first_body);
  read_near(n, rate);
  std::copy_n(near_.begin() + part.first, part.count, rates(n).begin());
  move(n);
  for (int i = 0; i < tree.bodies; ++i) {
    const Twist<T>& twist = twist_[part.first_body + i];
    const Mat3<T>& r = k.rotation[i];
    p.force[i] = tree.mass[i] * (history.velocity[i] - twist.at(k.center[i]));
    p.moment[i] = k.center[i].cross(p.force[i]) + history.momentum[i] -
                  r * (tree.inertia[i] * (r.transpose() * twist.w));
  }
  const std::span<T> projection = std::span(projection_).subspan(part.first_dof, tree.dofs);
  project_wrenches<T>(tree, k, p.force, p.moment, projection);
  for (int u = 0; u < part.count; ++u) {
    const int dof = dof_[part.first + u];
    rates(n)[u] = projection[dof] + (impulse.empty() ? T(0) : impulse[dof]);
  }
  solve_by_joints<T>(part.matrix, rates(n));
  for (int u = 0; u < part.count; ++u) rates(n)[u] += near_[part.first + u];
}

template <class T>
typename EndVelocities<T>::Row* EndVelocities<T>::open_row(int tree, int other) {
  if (pressed_.size() == kMost) return nullptr;
  Row row;
  row.tree[0] = tree;
  row.tree[1] = other == tree ? -1 : other;
  pressed_.push_back(row);
  return &pressed_.back();
}

/// Room for the entries of one side of a row, to which project_point and others add.
template <class T>
void EndVelocities<T>::begin_side(int n) {
  row_.assign(parts_[n].count, T(0));
}

/// Keeps the side that has been begun. False where there is no room.
template <class T>
bool EndVelocities<T>::add_side(Row& row, int n) {
  row.entry[n] = static_cast<int>(rows_.size());
  const Part& part = parts_[row.tree[n]];
  int last = part.count - 1;
  while (last >= 0 && row_[last] == T(0)) --last;
  if (last >= 0) {  // with the rest of its joint, which reduce() fills
    const JointBlock& block =
        part.matrix.blocks[problems_[row.tree[n]]->tree->dof_body[dof_[part.first + last]]];
    row.count[n] = block.first + block.count;
  }
  if (rows_.size() + row.count[n] > rows_.capacity()) return false;
  rows_.insert(rows_.end(), row_.begin(), row_.begin() + row.count[n]);
  return true;
}

/// Adds the speed of a body's point along `normal` per unit of each unknown's rate.
template <class T>
void EndVelocities<T>::project_point(int n, int body, const Vec3<T>& point, const Vec3<T>& normal, T sign) {
  const Part& part = parts_[n];
  const Tree<T>& tree = *problems_[n]->tree;
  const Kinematics<T>& k = problems_[n]->kinematics;
  while (body >= 0 && tree.dof_count(body) == 0) body = tree.parent[body];
  if (body < 0) return;
  const Vec3<T> moment = point.cross(normal);
  for (int dof = tree.first_dof[body + 1] - 1; dof >= 0; dof = tree.dof_parent[dof]) {
    const int unknown = of_dof_[part.first_dof + dof];
    if (unknown >= 0) row_[unknown] += sign * (k.v[dof].dot(normal) + k.w[dof].dot(moment));
  }
}

/// How a contact's first side moves against its second at `point` along `direction`.
template <class T>
typename EndVelocities<T>::Row* EndVelocities<T>::add_point(const Contact<T>& c, const Vec3<T>& point,
                                                            const Vec3<T>& direction) {
  Row* row = open_row(c.tree_a, c.tree_b);
  if (!row) return nullptr;
  row->unit = c.speed_scale;
  const auto given = [&](int n, int body) {
    const Tree<T>& tree = *problems_[n]->tree;
    Vec3<T> sum = Vec3<T>::Zero();
    for (; body >= 0; body = tree.parent[body]) sum += driven_[parts_[n].first_body + body].at(point);
    return sum.dot(direction);
  };
  begin_side(c.tree_a);
  project_point(c.tree_a, c.body_a, point, direction, T(1));
  row->given = given(c.tree_a, c.body_a);
  if (c.tree_b == c.tree_a) project_point(c.tree_b, c.body_b, point, direction, T(-1));
  bool fits = add_side(*row, 0);
  if (row->tree[1] >= 0) {
    begin_side(c.tree_b);
    project_point(c.tree_b, c.body_b, point, direction, T(-1));
    fits = fits && add_side(*row, 1);
  }
  if (c.tree_b >= 0) row->given -= given(c.tree_b, c.body_b);
  if (!fits) pressed_.pop_back();
  return fits ? row : nullptr;
}

template <class T>
void EndVelocities<T>::add(const Contact<T>& c, T most, T cone, const Vec3<T>& rubbed) {
  Row* normal = add_point(c, c.point, c.normal);
  if (!normal) return;
  normal->contact = c.id;
  normal->most = most;
  normal->friction = c.friction;
  normal->cone = cone;
  if (!(c.friction > T(0)) || pressed_.size() + 2 > kMost) return;
  const std::size_t at = pressed_.size() - 1;
  const Vec3<T> touch = c.point - c.radius * c.normal;  // however deep: what rolls has its own radius
  const Vec3<T> tangent = c.normal.unitOrthogonal();
  for (const Vec3<T>& direction : {tangent, Vec3<T>(c.normal.cross(tangent))})
    if (Row* row = add_point(c, touch, direction)) {
      row->impulse = rubbed.dot(direction);
      ++pressed_[at].grips;
    }
}

template <class T>
void EndVelocities<T>::add(int tree, const JointRow<T>& joint, T most) {
  Row* row = open_row(tree, -1);
  if (!row) return;
  const Tree<T>& of = *problems_[tree]->tree;
  row->unit = slides(of, joint.dof) ? of.scale.time : 1 / of.scale.time;
  row->most = most;
  begin_side(tree);
  for (int a = 0; a < joint.count; ++a) {
    const int unknown = of_dof_[parts_[tree].first_dof + joint.dof + a];
    if (unknown >= 0) row_[unknown] -= joint.gradient[a];
  }
  if (!add_side(*row, 0)) pressed_.pop_back();
}

/// Adds a row for Σ wᵢ vᵢ along `direction`, of no more than two trees.
template <class T>
void EndVelocities<T>::add_stencil(const Coupling<T>& coupling, const Stencil<T>& e, const Vec3<T>& direction,
                                   T speed, T least) {
  int trees[2] = {-1, -1};
  for (int k = 0; k < e.count; ++k) {
    const int tree = coupling.nodes[e.node[k]].tree;
    if (tree < 0 || tree == trees[0] || tree == trees[1]) continue;
    if (trees[1] >= 0) return;
    trees[trees[0] < 0 ? 0 : 1] = tree;
  }
  Row* const row = trees[0] < 0 ? nullptr : open_row(trees[0], trees[1] < 0 ? trees[0] : trees[1]);
  if (!row) return;
  row->given = -speed;
  row->unit = coupling.speed_scale;
  row->least = least;
  row->most = std::numeric_limits<T>::max();
  bool fits = true;
  for (int n = 0; n < row->sides(); ++n) {
    begin_side(trees[n]);
    for (int k = 0; k < e.count; ++k) {
      const CouplingNode<T>& node = coupling.nodes[e.node[k]];
      if (node.tree != trees[n]) continue;
      project_point(node.tree, node.body, node.point, direction, e.weight[k]);
      const Tree<T>& tree = *problems_[node.tree]->tree;
      for (int body = node.body; body >= 0; body = tree.parent[body])
        row->given +=
            e.weight[k] * driven_[parts_[node.tree].first_body + body].at(node.point).dot(direction);
    }
    fits = fits && add_side(*row, n);
  }
  if (!fits) pressed_.pop_back();
}

template <class T>
void EndVelocities<T>::add(const Coupling<T>& coupling, const Stencil<T>& e) {
  if (e.yields) return;
  constexpr T kAnything = std::numeric_limits<T>::max();
  const Vec3<T> leads = closing_velocity(coupling, e);
  if (!(e.length > T(0))) {
    for (int a = 0; a < 3; ++a) add_stencil(coupling, e, Vec3<T>::Unit(a), leads[a], -kAnything);
    return;
  }
  const Vec3<T> reached = reach(coupling, e) - e.offset;
  const T size = reached.norm();
  if (e.only_pulls && !(size > e.length)) return;
  const Vec3<T> shortens = reached / -std::max(size, e.length);
  add_stencil(coupling, e, shortens, leads.dot(shortens), e.only_pulls ? T(0) : -kAnything);
}

/// Speed along a row. Before anything has pushed its trees it is `given`.
template <class T>
T EndVelocities<T>::opening(Row& row) {
  T sum = row.given;
  for (int n = 0; n < row.sides(); ++n) {
    if (!disturbed_[row.tree[n]]) continue;
    (void)reduce(row);
    sum += dot<T>(side(row, n), std::span(done_).subspan(parts_[row.tree[n]].first));
  }
  return sum;
}

/// Turns a row's entries J into L⁻ᵀJᵀ, whose square is its mobility: along the paths of its bodies. False:
/// nothing moves it.
template <class T>
bool EndVelocities<T>::reduce(Row& row) {
  if (row.reduced) return row.mobility > T(0);
  row.reduced = true;
  for (int n = 0; n < row.sides(); ++n) {
    const std::span<T> entries = side(row, n);
    if (entries.empty()) continue;
    const ArticulatedParts<T>& m = parts_[row.tree[n]].matrix;
    int last = 0;
    on_path_.assign(m.bodies, 0);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if (entries[k] == T(0)) continue;
      last = problems_[row.tree[n]]->tree->dof_body[dof_[parts_[row.tree[n]].first + k]];
      for (int i = last; i >= 0 && !on_path_[i]; i = m.blocks[i].parent) {
        on_path_[i] = 1;
        m.force[i].setZero();
      }
    }
    for (int i = last; i >= 0; --i)
      if (on_path_[i]) reduce_joint<T>(m, i, entries);
    row.mobility += dot<T>(entries, entries);
  }
  return row.mobility > T(0);
}

template <class T>
void EndVelocities<T>::push(Row& row, T change) {
  row.impulse += change;
  for (int n = 0; n < row.sides(); ++n) {
    disturbed_[row.tree[n]] = 1;
    const std::span<const T> entries = side(row, n);
    using Entries = Eigen::Array<T, Eigen::Dynamic, 1>;
    Eigen::Map<Entries>(done_.data() + parts_[row.tree[n]].first, std::ssize(entries)) +=
        change * Eigen::Map<const Entries>(entries.data(), std::ssize(entries));
  }
}

/// What the impulses make of the rates.
template <class T>
void EndVelocities<T>::spread() {
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (!disturbed_[n]) continue;
    const std::span<T> done = std::span(done_).subspan(parts_[n].first, parts_[n].count);
    expand_by_joints<T>(parts_[n].matrix, done);
    for (int u = 0; u < parts_[n].count; ++u) rates(static_cast<int>(n))[u] += done[u];
  }
}

template <class T>
void EndVelocities<T>::begin_pressing() {
  disturbed_.assign(parts_.size(), 0);
  std::fill(done_.begin(), done_.end(), T(0));
  for (Row& row : pressed_)
    for (int n = 0; n < row.sides(); ++n) row.given += dot<T>(side(row, n), rates(row.tree[n]));
}

/// One row's turn, with its friction: by how much the speeds of these changed at most.
template <class T>
T EndVelocities<T>::press_row(Row& row) {
  T most = T(0);
  const T opens = opening(row) - row.floor;
  const bool acts = opens < T(-kLeft) * row.unit || (row.least < T(0) && opens > T(kLeft) * row.unit) ||
                    row.impulse != T(0);
  if (row.most > T(0) && acts && reduce(row)) {
    const T change = std::clamp(row.impulse - opens / row.mobility, row.least, row.most) - row.impulse;
    push(row, change);
    most = std::max(most, std::abs(change * row.mobility) / row.unit);
  }
  const T grip = row.friction * row.impulse + row.cone;
  if (row.grips < 2 || !(grip > T(0))) return most;
  Row* const rubs = &row + 1;
  const T slides[2] = {opening(rubs[0]), opening(rubs[1])};
  // Already as much as it can be, and against the motion.
  const auto length = [](T x, T y) { return std::sqrt(x * x + y * y); };
  const T used = length(rubs[0].impulse, rubs[1].impulse), speed = length(slides[0], slides[1]),
          against = -(slides[0] * rubs[0].impulse + slides[1] * rubs[1].impulse);
  if (speed < T(kStill) * row.unit && used <= grip) return most;
  const bool all = used > T(kUsed) * grip && !(T(kUsed) * used > grip);
  if (all && against > T(kUsed) * used * speed) return most;
  T wanted[2];
  for (int a = 0; a < 2; ++a)
    wanted[a] = reduce(rubs[a]) ? rubs[a].impulse - slides[a] / rubs[a].mobility : T(0);
  const T size = length(wanted[0], wanted[1]), share = size > grip ? grip / size : T(1);
  for (int a = 0; a < 2; ++a) {
    const T change = share * wanted[a] - rubs[a].impulse;
    push(rubs[a], change);
    most = std::max(most, std::abs(change * rubs[a].mobility) / row.unit);
  }
  return most;
}

template <class T>
void EndVelocities<T>::press() {
  if (pressed_.empty()) return;
  begin_pressing();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    T most = T(0);
    for (std::size_t at = 0; at < pressed_.size(); at += 1 + pressed_[at].grips)
      most = std::max(most, press_row(pressed_[at]));
    if (most < T(kLeft)) break;
  }
  spread();
}

/// The unknowns' rates as those of joint offsets: the other way round than read_near().
template <class T>
void EndVelocities<T>::add_striking(const Contact<T>& c, T drift, const Bounce<T>& bounce) {
  const std::size_t at = pressed_.size();
  add(c, std::numeric_limits<T>::max(), T(0), Vec3<T>::Zero());
  if (pressed_.size() == at) return;
  pressed_[at].gap = c.start_gap;
  pressed_[at].size = c.length_scale;
  pressed_[at].drift = drift;
  pressed_[at].bounce = bounce;
}

template <class T>
void EndVelocities<T>::add_bearing(const Contact<T>& c) {
  const std::size_t at = pressed_.size();
  add(c, std::numeric_limits<T>::max(), T(0), Vec3<T>::Zero());
  if (pressed_.size() > at) pressed_[at].bears = true;
}

template <class T>
void EndVelocities<T>::add_tied(const Coupling<T>& coupling, const Stencil<T>& e) {
  std::size_t at = pressed_.size();
  for (add(coupling, e); at < pressed_.size(); ++at) pressed_[at].bears = true;
}

template <class T>
void EndVelocities<T>::add_limit(int tree, const JointRow<T>& joint, bool bears, T slow) {
  const std::size_t at = pressed_.size();
  add(tree, joint, std::numeric_limits<T>::max());
  if (pressed_.size() == at) return;
  pressed_[at].gap = std::max(-joint.value, T(0));
  const Tree<T>& of = *problems_[tree]->tree;
  pressed_[at].size = slides(of, joint.dof) ? of.scale.length : T(1);
  pressed_[at].bears = bears && joint.value > T(-kTouches) * pressed_[at].size;
  pressed_[at].slow = slow;
}

/// Whether a row that opens at such a speed closes faster than what is too slow to strike.
template <class T>
bool EndVelocities<T>::closes(const Row& row, T opens, T slow) const {
  return !row.bears && opens <= -std::max(slow, row.slow) * row.unit;
}

/// s until the next strike, less than `left`; `left`: none.
template <class T>
T EndVelocities<T>::wait_for_strike(T left, T slow) {
  for (std::size_t at = 0; at < pressed_.size(); at += 1 + pressed_[at].grips) {
    Row& row = pressed_[at];
    const T opens = opening(row), speed = opens + row.drift;
    if (!closes(row, opens, slow)) continue;
    if (!(row.gap > T(0)))
      left = T(0);
    else if (speed < T(0))
      left = std::min(left, row.gap / -speed);
  }
  return left;
}

/// At a strike when `share` of the step is over: whether a row takes part, and at what speed it is to open.
/// Its drift is half of what it gains in the step, of which it has that share by then, and goes on with the
/// rest.
template <class T>
void EndVelocities<T>::choose_floor(Row& row, T slow, T share) {
  row.acts = !(row.gap > T(kTouches) * row.size);
  if (row.bears || !(row.bounce.share > T(0)) || !row.acts) return;
  const T opens = opening(row), gained = 2 * share * row.drift, closing = -opens - gained;
  row.acts = closes(row, opens, slow);
  row.floor = closing < row.bounce.from ? T(0) : std::max(row.bounce.share * closing - gained, T(0));
}

template <class T>
bool EndVelocities<T>::strike(T h, T slow) {
  begin_pressing();
  std::fill(late_.begin(), late_.end(), T(0));
  const auto for_each = [&](const auto& act) {
    for (std::size_t at = 0; at < pressed_.size(); at += 1 + pressed_[at].grips) act(pressed_[at]);
  };
  for_each([&](Row& row) {
    if (row.bears) row.floor = row.least < T(0) ? opening(row) : std::min(opening(row), T(0));
  });
  const int unknowns = parts_.back().first + parts_.back().count;
  T now = T(0);
  for (int n = 0; n < kStrikes; ++n) {
    const T wait = wait_for_strike(h - now, slow);
    if (!(wait < h - now)) break;
    now += wait;
    for_each([&](Row& row) { row.gap += row.bears ? T(0) : wait * (opening(row) + row.drift); });
    for (Row& row : pressed_) row.impulse = T(0);
    for_each([&](Row& row) { choose_floor(row, slow, now / h); });
    std::copy_n(done_.begin(), unknowns, before_.begin());
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      T most = T(0);
      for_each([&](Row& row) { most = row.acts ? std::max(most, press_row(row)) : most; });
      if (most < T(kLeft)) break;
    }
    for (Row& row : pressed_) row.struck += row.impulse;
    for (int u = 0; u < unknowns; ++u) late_[u] += now / h * (done_[u] - before_[u]);
  }
  spread();
  return std::any_of(disturbed_.begin(), disturbed_.end(), [](std::uint8_t x) { return x != 0; });
}

template <class T>
void EndVelocities<T>::strike_changed(int n, std::span<std::array<T, 6>> rate) {
  const Part& part = parts_[n];
  std::copy_n(done_.begin() + part.first, part.count, rates(n).begin());
  answered(n, rate);
}

template <class T>
void EndVelocities<T>::missed(int n, std::span<Vec3<T>> moved, std::span<Vec3<T>> turned) {
  const Part& part = parts_[n];
  const int bodies = problems_[n]->tree->bodies;
  std::copy_n(late_.begin() + part.first, part.count, rates(n).begin());
  expand_by_joints<T>(part.matrix, rates(n));
  std::fill_n(driven_.begin() + part.first_body, bodies, Twist<T>());
  move(n);
  for (int i = 0; i < bodies; ++i) {
    const Twist<T>& twist = twist_[part.first_body + i];
    turned[i] = twist.w;
    moved[i] = twist.at(problems_[n]->kinematics.center[i]);
  }
}

/// The unknowns' rates as those of joint offsets: the other way round than read_near().
template <class T>
void EndVelocities<T>::read_rates(int n, std::span<std::array<T, 6>> rate) {
  const Part& part = parts_[n];
  const Tree<T>& tree = *problems_[n]->tree;
  for (int u = 0; u < part.count; ++u) {
    const int dof = dof_[part.first + u], body = tree.dof_body[dof];
    rate[body][dof - tree.first_dof[body]] = rates(n)[u];
  }
  for (int i = 0; i < tree.bodies; ++i) {
    if (tree.type[i] != JointType::kFree || !loose(n, tree.first_dof[i])) continue;
    const Vec3<T> turned =
        problems_[n]->local[i].rotation.conjugate() * Vec3<T>(rate[i][3], rate[i][4], rate[i][5]);
    for (int a = 0; a < 3; ++a) rate[i][3 + a] = turned[a];
  }
}

template <class T>
void EndVelocities<T>::answered(int n, std::span<std::array<T, 6>> rate) {
  std::fill(rate.begin(), rate.end(), std::array<T, 6>{});
  read_rates(n, rate);
}

template <class T>
void EndVelocities<T>::write(int n, History<T>& history, std::span<std::array<T, 6>> rate) {
  const Part& part = parts_[n];
  const Tree<T>& tree = *problems_[n]->tree;
  const Kinematics<T>& k = problems_[n]->kinematics;
  read_rates(n, rate);
  move(n);
  for (int i = 0; i < tree.bodies; ++i) {
    const Twist<T>& twist = twist_[part.first_body + i];
    const Mat3<T>& r = k.rotation[i];
    history.velocity[i] = twist.at(k.center[i]);
    history.momentum[i] = r * (tree.inertia[i] * (r.transpose() * twist.w));
    history.rotation_rate[i] = rotation_rate_of<T>(tree, i, r, history.momentum[i]);
  }
}

template class EndVelocities<float>;
template class EndVelocities<double>;

}  // namespace sinew
