#include "export/gltf.h"

#include <algorithm>
#include <cmath>

#include "export/clip_extras.h"
#include "export/gltf_file.h"
#include "export/gltf_skin.h"
#include "sinew/skeleton/version.h"

namespace sinew::exporting {
namespace {

using nlohmann::json;
using Use = GltfFile::Use;

constexpr double kStill = 1e-7;  ///< m, and length of a difference of quaternions: rounding of floats

/// One node's motion over the keys.
struct Track {
  std::vector<Quat<double>> rotations, rotation_rates;  ///< neighbours on the same side; 1/s
  std::vector<Vec3<double>> translations, velocities;
};

/// The derivative of a rotation as a quaternion: q' = q·(0, ω)/2, ω in the child's axes.
Quat<double> rate_of(const Quat<double>& q, const Vec3<double>& omega) {
  Quat<double> rate = q * Quat<double>(0, omega.x(), omega.y(), omega.z());
  rate.coeffs() *= 0.5;
  return rate;
}

Track track_of(const Motion& motion, std::size_t joint, bool root) {
  const Quat<double> turn = root ? to_y_up() : Quat<double>::Identity();
  Track track;
  for (const std::vector<JointJet<double>>& frame : motion.frames) {
    const JointJet<double>& jet = frame[joint];
    Quat<double> q = (turn * jet.rotation).normalized();
    if (!track.rotations.empty() && q.dot(track.rotations.back()) < 0) q.coeffs() = -q.coeffs();
    track.rotations.push_back(q);
    track.rotation_rates.push_back(rate_of(q, jet.omega));
    track.translations.emplace_back(turn * jet.translation);
    track.velocities.emplace_back(turn * jet.velocity);
  }
  return track;
}

/// Values of a sampler: keys, or of splines in-tangent, key, out-tangent.
template <class V>
std::vector<float> sampler_values(const std::vector<V>& keys, const std::vector<V>& rates, bool cubic) {
  std::vector<float> values;
  const auto put = [&](const V& v) {
    if constexpr (std::is_same_v<V, Quat<double>>)
      for (int k = 0; k < 4; ++k) values.push_back(static_cast<float>(v.coeffs()[k]));
    else
      for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(v[k]));
  };
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (cubic) put(rates[k]);
    put(keys[k]);
    if (cubic) put(rates[k]);
  }
  return values;
}

/// One animation of the file, to which channels of several figures may be added.
class Animation {
 public:
  Animation(std::string name, const std::vector<double>& times, bool cubic, GltfFile& file)
      : file_(file), cubic_(cubic && times.size() > 1) {
    animation_["name"] = std::move(name);
    std::vector<float> keys;
    for (const double t : times) keys.push_back(static_cast<float>(t));
    input_ = file.add_numbers(keys, "SCALAR", Use::kOther, true);
  }

  /// Leaves out what never leaves the node's rest, but for roots (whose place is part of any pose).
  void add_joint(const Motion& motion, std::size_t joint, const Joint& rest, int node) {
    const bool root = rest.parent < 0;
    const Track track = track_of(motion, joint, root);
    bool turns = root, moves = root;
    for (std::size_t k = 0; k < track.rotations.size(); ++k) {
      const Vec4 q = track.rotations[k].coeffs(), r = rest.rest.rotation.coeffs();
      turns = turns || std::min((q - r).norm(), (q + r).norm()) > kStill;
      moves = moves || (track.translations[k] - rest.rest.translation).norm() > kStill;
    }
    if (turns) add_channel(node, "rotation", track.rotations, track.rotation_rates);
    if (moves) add_channel(node, "translation", track.translations, track.velocities);
  }

  /// Weights of morph targets, as straight lines; left out where they stay at rest.
  void add_weights(const Motion& motion, const Asset& asset, const FigureNodes::Morphing& morphing) {
    std::vector<float> weights;
    bool moves = false;
    for (const std::vector<double>& values : motion.curves)
      for (const int slot : morphing.mesh->morph_curves) {
        const auto at = static_cast<std::size_t>(slot);
        weights.push_back(static_cast<float>(values[at]));
        moves = moves || std::abs(values[at] - double(asset.curve_slots[at].rest)) > kStill;
      }
    if (moves) add_sampler(morphing.node, "weights", weights, "SCALAR", "LINEAR");
  }

  template <class V>
  void add_channel(int node, const char* path, const std::vector<V>& keys, const std::vector<V>& rates) {
    const bool rotation = std::is_same_v<V, Quat<double>>;
    add_sampler(node, path, sampler_values(keys, rates, cubic_), rotation ? "VEC4" : "VEC3",
                cubic_ ? "CUBICSPLINE" : "LINEAR");
  }

  /// Each value holds until the next.
  void add_steps(int node, const char* path, const std::vector<Vec3<double>>& keys) {
    add_sampler(node, path, sampler_values(keys, keys, false), "VEC3", "STEP");
  }

  void set_extras(json extras) { animation_["extras"] = std::move(extras); }
  void finish() { file_.add("animations", std::move(animation_)); }

 private:
  using Vec4 = Eigen::Vector4d;

  void add_sampler(int node, const char* path, const std::vector<float>& values, const char* type,
                   const char* interpolation) {
    const int output = file_.add_numbers(values, type, Use::kOther);
    json& samplers = animation_["samplers"];
    samplers.push_back({{"input", input_}, {"output", output}, {"interpolation", interpolation}});
    animation_["channels"].push_back(
        {{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  GltfFile& file_;
  bool cubic_;
  int input_ = 0;
  json animation_;
};

/// Where a prop is; before it appears it has no size, and waits where it will.
void add_prop(const GltfProp& prop, int node, Animation& animation) {
  std::vector<Quat<double>> rotations;
  std::vector<Vec3<double>> translations, sizes;
  std::size_t first = 0;
  while (first < prop.hidden.size() && prop.hidden[first]) ++first;
  for (std::size_t k = 0; k < prop.poses.size(); ++k) {
    const bool hidden = prop.hidden[k];
    sizes.push_back(hidden ? Vec3<double>(Vec3<double>::Zero()) : Vec3<double>(Vec3<double>::Ones()));
    const std::size_t shown = hidden && first < prop.poses.size() ? first : k;
    const Transform<double> x = prop.poses[shown].cast<double>();  // its mesh is turned already
    Quat<double> q = (to_y_up() * x.rotation * to_y_up().conjugate()).normalized();
    if (!rotations.empty() && q.dot(rotations.back()) < 0) q.coeffs() = -q.coeffs();
    rotations.push_back(q);
    translations.emplace_back(to_y_up() * x.translation);
  }
  animation.add_channel(node, "rotation", rotations, rotations);
  animation.add_channel(node, "translation", translations, translations);
  if (first > 0) animation.add_steps(node, "scale", sizes);
}

/// An animation's name, keys and clip (of the first figure that has it).
struct Heading {
  std::string name;
  const std::vector<double>* times;
  const Clip* clip;
  const Asset* asset;
};

std::vector<Heading> headings_of(const GltfContent& content) {
  std::vector<Heading> all;
  const auto add = [&](const Heading& heading) {
    const auto same = [&](const Heading& h) { return h.name == heading.name; };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(heading);
  };
  for (const GltfFigure& figure : content.figures)
    for (const Motion& motion : figure.motions) add({motion.name, &motion.times, motion.clip, figure.asset});
  for (const GltfProp& prop : content.props) add({prop.motion, &prop.times, nullptr, nullptr});
  return all;
}

/// Every animation: what figures and props do in it together.
void add_animations(const GltfContent& content, const std::vector<FigureNodes>& nodes,
                    const std::vector<int>& prop_nodes, GltfFile& file) {
  for (const Heading& heading : headings_of(content)) {
    // The velocities of a simulated result are not known: straight lines.
    Animation animation(heading.name, *heading.times, content.cubic && heading.clip, file);
    for (std::size_t f = 0; f < content.figures.size(); ++f)
      for (const Motion& motion : content.figures[f].motions) {
        if (motion.name != heading.name) continue;
        const Asset& asset = *content.figures[f].asset;
        const std::vector<Joint>& joints = asset.skeleton.joints;
        for (std::size_t j = 0; j < joints.size(); ++j)
          animation.add_joint(motion, j, joints[j], nodes[f].first_joint + static_cast<int>(j));
        for (const FigureNodes::Morphing& mesh : nodes[f].morphing)
          animation.add_weights(motion, asset, mesh);
      }
    for (std::size_t p = 0; p < content.props.size(); ++p)
      if (content.props[p].motion == heading.name) add_prop(content.props[p], prop_nodes[p], animation);
    if (heading.clip) animation.set_extras(clip_extras(*heading.asset, *heading.clip));
    animation.finish();
  }
}

}  // namespace

std::string write_gltf(const GltfContent& content) {
  GltfFile file;
  file.document["asset"] = {{"version", "2.0"}, {"generator", std::string("Sinew ") + version()}};
  file.document["scene"] = 0;
  file.document["scenes"] = {{{"nodes", json::array()}}};
  std::vector<FigureNodes> nodes;
  std::vector<int> prop_nodes;
  for (const GltfFigure& figure : content.figures) nodes.push_back(add_figure(figure, content.surface, file));
  for (const GltfProp& prop : content.props) prop_nodes.push_back(add_solid(prop.prop, file));
  add_animations(content, nodes, prop_nodes, file);
  if (content.figures.size() == 1)
    if (const json extras = asset_extras(*content.figures[0].asset); !extras.is_null())
      file.document["extras"] = extras;
  return content.binary ? file.as_glb() : file.as_gltf();
}

}  // namespace sinew::exporting
