#include "export/bvh.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "export/body_parts.h"

namespace sinew::exporting {
namespace {

constexpr double kStill = 1e-6;   ///< m: joints that move less keep their distance
constexpr double kLocked = 1e-7;  ///< cosine of the middle angle below which the outer two are one turn

/// Angles about z, x and y, rad, whose turns in this order make a rotation.
using Angles = std::array<double, 3>;

/// The one of both sets of angles, and of their whole turns, that is nearest to `before`, so that lines
/// between frames go the short way.
Angles nearest(const Angles& found, const Angles& before) {
  constexpr double kHalf = std::numbers::pi;
  Angles best{};
  double least = 1e300;
  for (Angles set : {found, Angles{found[0] + kHalf, kHalf - found[1], found[2] + kHalf}}) {
    double away = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      set[k] -= 2 * kHalf * std::round((set[k] - before[k]) / (2 * kHalf));
      away += (set[k] - before[k]) * (set[k] - before[k]);
    }
    if (away < least) {
      least = away;
      best = set;
    }
  }
  return best;
}

Angles angles_of(const Quat<double>& rotation, const Angles& before) {
  const Mat3<double> r = rotation.toRotationMatrix();
  const double cosine = std::hypot(r(2, 0), r(2, 2));
  Angles found{0, std::atan2(r(2, 1), cosine), before[2]};
  if (cosine > kLocked) {
    found[0] = std::atan2(-r(0, 1), r(1, 1));
    found[2] = std::atan2(-r(2, 0), r(2, 2));
  } else {
    found[0] = std::atan2(r(1, 0), r(0, 0)) - (r(2, 1) > 0 ? found[2] : -found[2]);
  }
  return nearest(found, before);
}

std::string numbers(const Vec3<double>& v) {
  char line[80];
  std::snprintf(line, sizeof line, "%.6f %.6f %.6f", v.x(), v.y(), v.z());
  return line;
}

class Writer {
 public:
  Writer(const Skeleton& skeleton, const Motion& motion)
      : s_(skeleton), motion_(motion), names_(unique_names(skeleton)) {
    children_.resize(s_.joints.size());
    for (std::size_t j = 0; j < s_.joints.size(); ++j)
      if (s_.joints[j].parent >= 0) children_[static_cast<std::size_t>(s_.joints[j].parent)].push_back(j);
    for (const Transform<double>& x : rest_pose(s_))
      rest_.push_back({to_y_up() * x.rotation, to_y_up() * x.translation});
    for (std::size_t j = 0; j < s_.joints.size(); ++j) {
      moves_.push_back(s_.joints[j].parent < 0);
      const Vec3<double>& first = motion_.frames[0][j].translation;
      for (const auto& frame : motion_.frames)
        if ((frame[j].translation - first).norm() > kStill) moves_[j] = true;
    }
  }

  std::string text(std::vector<std::string>& notes) {
    std::size_t root = 0;
    while (s_.joints[root].parent >= 0) ++root;
    std::string out = "HIERARCHY\n";
    joint(root, "", out, notes);
    const double length = motion_.times.size() > 1 ? motion_.times[1] - motion_.times[0] : 1.0 / 60;
    char line[80];
    std::snprintf(line, sizeof line, "MOTION\nFrames: %zu\nFrame Time: %.9f\n", motion_.times.size(), length);
    out += line;
    std::vector<Angles> before(s_.joints.size(), Angles{});
    for (const auto& frame : motion_.frames) out += row(frame, before);
    return out;
  }

 private:
  /// Where a joint is from its parent at rest, along the world's axes.
  Vec3<double> offset(std::size_t j) const {
    const auto parent = static_cast<std::size_t>(s_.joints[j].parent);
    const Vec3<double> local = moves_[j] ? s_.joints[j].rest.translation : motion_.frames[0][j].translation;
    return rest_[parent].rotation * local;
  }

  std::string name(std::size_t j, std::vector<std::string>& notes) const {
    std::string plain = names_[j];
    for (char& c : plain)
      if (c == ' ' || c == '\t' || c == '{' || c == '}') c = '_';
    if (plain != s_.joints[j].name)
      notes.push_back("joint '" + s_.joints[j].name + "' is called '" + plain +
                      "': in BVH names are unique and have no spaces");
    return plain;
  }

  void joint(std::size_t j, const std::string& indent, std::string& out, std::vector<std::string>& notes) {
    const bool root = s_.joints[j].parent < 0;
    order_.push_back(j);
    out += indent + (root ? "ROOT " : "JOINT ") + name(j, notes) + "\n" + indent + "{\n";
    const std::string inner = indent + "  ";
    out += inner + "OFFSET " + numbers(root ? Vec3<double>(Vec3<double>::Zero()) : offset(j)) + "\n";
    out += inner + (moves_[j] ? "CHANNELS 6 Xposition Yposition Zposition " : "CHANNELS 3 ") +
           "Zrotation Xrotation Yrotation\n";
    for (const std::size_t child : children_[j]) joint(child, inner, out, notes);
    if (children_[j].empty()) {  // half as far again, so that the bone can be seen
      const Vec3<double> along = root ? Vec3<double>(Vec3<double>::Zero()) : offset(j);
      const Vec3<double> tip = along.norm() > 1e-3 ? Vec3<double>(0.5 * along) : Vec3<double>(0, 0.05, 0);
      out += inner + "End Site\n" + inner + "{\n" + inner + "  OFFSET " + numbers(tip) + "\n" + inner + "}\n";
    }
    out += indent + "}\n";
  }

  std::string row(const std::vector<JointJet<double>>& frame, std::vector<Angles>& before) const {
    // Turns from rest, along the world's axes.
    std::vector<Quat<double>> turns;
    const std::vector<Transform<double>> pose = model_pose(s_, frame);
    for (std::size_t j = 0; j < pose.size(); ++j)
      turns.push_back(to_y_up() * pose[j].rotation * rest_[j].rotation.conjugate());
    std::string line;
    for (const std::size_t j : order_) {
      const int above = s_.joints[j].parent;
      const auto parent = static_cast<std::size_t>(above);
      if (!line.empty()) line += ' ';
      if (above < 0)
        line += numbers(to_y_up() * pose[j].translation) + " ";
      else if (moves_[j])
        line += numbers(rest_[parent].rotation * frame[j].translation) + " ";
      const Quat<double> local = above < 0 ? turns[j] : turns[parent].conjugate() * turns[j];
      before[j] = angles_of(local.normalized(), before[j]);
      const double degree = 180 / std::numbers::pi;
      line += numbers(degree * Vec3<double>(before[j][0], before[j][1], before[j][2]));
    }
    return line + "\n";
  }

  const Skeleton& s_;
  const Motion& motion_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<Transform<double>> rest_;  ///< Y up
  std::vector<bool> moves_;              ///< has position channels
  std::vector<std::size_t> order_;       ///< as the file has its joints
};

}  // namespace

convert::Error write_bvh(const Skeleton& skeleton, const Motion& motion, std::string& out,
                         std::vector<std::string>& notes) {
  std::string roots;
  int count = 0;
  for (const Joint& joint : skeleton.joints)
    if (joint.parent < 0 && ++count > 0) roots += (count > 1 ? ", '" : "'") + joint.name + "'";
  if (count > 1) return {"it has " + std::to_string(count) + " roots (" + roots + "), and BVH holds one"};
  out = Writer(skeleton, motion).text(notes);
  return {};
}

}  // namespace sinew::exporting
