// Clean-up of a source scene: which nodes are joints, where they are in metres and Z up, rigid, at rest and
// over each clip.
#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "convert/convert.h"
#include "convert/options.h"
#include "import/source_scene.h"

namespace sinew::convert {

/// Joints of a character with rigid transforms. Parents come first; index 0 is the root.
struct Rig {
  struct Joint {
    std::string name;
    int parent = -1;
    int node = -1;           ///< in the source scene
    Transform<double> rest;  ///< model space, m
    double skin_weight = 0;  ///< sum over vertices
    bool control = false;    ///< steers others, is no body part
  };
  struct Motion {
    std::string name;
    double sample_rate = 30;    ///< Hz, of even samples; in the middle, of uneven ones
    std::vector<double> times;  ///< s, of samples whose times are uneven; else empty
    bool loops = false;
    double begin = 0;                                     ///< s in the file, of the first frame
    std::string extras;                                   ///< see import::SourceClip
    std::vector<std::vector<Transform<double>>> samples;  ///< [frame][joint] local
    /// Of morph targets, by the curve that moves them: (s, weight).
    std::map<std::string, std::vector<std::pair<double, double>>> morph_keys;

    /// s, of a frame.
    double time(int frame) const { return times.empty() ? frame / sample_rate : times[std::size_t(frame)]; }
  };
  /// A scene whose clips are for another skeleton.
  struct Foreign {
    std::size_t scene = 0;
    std::string why;
  };
  std::vector<Joint> joints;
  std::vector<Foreign> foreign;  ///< left out
  std::vector<Mesh> meshes;      ///< drawn; model space at rest; Mesh::joints index `joints`
  std::vector<std::vector<std::string>> morph_names;  ///< [mesh][morph] the curve that moves it
  std::map<std::string, double> morph_rest;           ///< where no clip moves it
  std::vector<Mesh>
      body_meshes;  ///< named UCX_…, as Unreal names them: the body is fitted to them, not drawn
  std::vector<Material> materials;
  std::vector<Motion> motions;
  double unit = 1;
  int up = 1;
  double turned = 0;  ///< rad about the vertical, so that it faces x
  double height = 0;  ///< m, at rest or in the first frame

  /// What the physical body is fitted to.
  std::span<const Mesh> skin() const { return body_meshes.empty() ? meshes : body_meshes; }
};

/// Builds the rig from the scene that carries the character; more scenes add clips (joints matched by name,
/// prefixes up to ':' or '|' ignored). `report` gains "unit", "up", "height" and "notes".
Error build_rig(const std::vector<import::SourceScene>& scenes, const Options& options, Rig& out,
                nlohmann::json& report);

}  // namespace sinew::convert
