// What a reader found in a source file, before anything is decided about it: nodes, meshes, clips as they
// stand in the file, in the file's own unit and axes. Produced by the sandboxed child (read_source), consumed
// by tools/convert.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sinew/skeleton/skeleton.h"

namespace sinew::import {

struct SourceNode {
  std::string name;           ///< unique within the scene (made so; see `original_name`)
  std::string original_name;  ///< as in the file, perhaps empty or repeated
  int parent = -1;            ///< parents first
  Eigen::Matrix4d local =
      Eigen::Matrix4d::Identity();  ///< child → parent, column vectors; may hold scale or mirror
  bool is_bone = false;             ///< named by a skin, or a joint of the format itself
};

struct SourceMesh {
  std::string name;
  int node = -1;  ///< node that carries it
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<std::array<float, 2>> uvs;
  std::vector<std::uint32_t> indices;  ///< triangles
  struct Bone {
    int node = -1;
    Eigen::Matrix4d inverse_bind = Eigen::Matrix4d::Identity();  ///< mesh space → bone space
    std::vector<std::pair<std::uint32_t, float>> weights;        ///< vertex, weight as in the file
  };
  std::vector<Bone> bones;
  int material = -1;
  struct Morph {
    std::string name;                              ///< as in the file, perhaps empty
    float weight = 0;                              ///< where no clip moves it
    std::vector<std::array<float, 3>> moves;       ///< [vertex] at weight 1
    std::vector<std::array<float, 3>> tilts = {};  ///< [vertex] of normals, or empty
  };
  std::vector<Morph> morphs;
};

struct SourceMaterial {
  std::string name;
  std::array<float, 4> base_color{0.8f, 0.8f, 0.8f, 1};
  std::vector<std::uint8_t> texture;  ///< encoded image bytes (PNG or JPEG), or empty
};

struct SourceChannel {
  int node = -1;
  std::vector<double> position_times, rotation_times, scale_times;  ///< s
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<Eigen::Vector3d> scales;
};

/// Weights of the morph targets of one mesh.
struct SourceMorphChannel {
  int mesh = -1;
  std::vector<double> times;   ///< s
  std::vector<float> weights;  ///< [key][morph]
};

struct SourceClip {
  std::string name;
  double duration = 0;  ///< s
  double begin = 0;     ///< s in the file, of what is 0 here
  double key_rate = 0;  ///< 1/s, of the channel with the closest keys; 0 when no channel has two
  std::string extras;   ///< glTF: what its author added to the animation, as JSON; else empty
  std::vector<SourceChannel> channels;
  std::vector<SourceMorphChannel> morphs;
};

/// A URDF, link by link (SI units, Z up). Joint i moves link i+1…: see `links[k].parent`.
struct SourceUrdfLink {
  std::string name, joint_name;
  int parent = -1;
  JointType type = JointType::kFixed;  ///< "floating" → kFree, "continuous" → kRevolute without limits
  Transform<double> origin;  ///< joint frame → parent link, at rest: of a locked joint, where it is locked
  Vec3<double> axis = Vec3<double>::UnitX();
  bool has_inertial = false;
  double mass = 0;
  Transform<double> inertial_origin;
  Mat3<double> inertia = Mat3<double>::Zero();  ///< in inertial_origin axes
  bool has_limits = false;
  double lower = 0, upper = 0, effort = 0, velocity = 0, damping = 0, friction = 0;
  std::string mimic_joint;
  double mimic_multiplier = 1, mimic_offset = 0;
  struct Geometry {
    Shape shape = Shape::kBox;
    Transform<double> origin;
    Vec3<double> size = Vec3<double>::Zero();  ///< as Collider::size
    bool collision = true;
  };
  std::vector<Geometry> shapes;  ///< primitives only
  struct MeshReference {
    std::string file;  ///< as it stands in the URDF
    Transform<double> origin;
    Vec3<double> scale = Vec3<double>::Ones();
    std::array<float, 4> color{0.8f, 0.8f, 0.8f, 1};  ///< linear, of the visual; a mesh's own goes before
    bool collision = false;
  };
  std::vector<MeshReference> meshes;
};

struct SourceScene {
  std::string format;             ///< "gltf", "fbx", "bvh", "collada", "urdf"
  std::string name;               ///< from the file, or its stem
  double meters_per_unit = 0;     ///< 0: the file does not say
  int up_axis = -1;               ///< 0 X, 1 Y, 2 Z; -1: the file does not say
  std::vector<SourceNode> nodes;  ///< of a URDF: its links, then what carries their meshes (read_link_meshes)
  std::vector<SourceMesh> meshes;
  std::vector<SourceMaterial> materials;
  std::vector<SourceClip> clips;
  std::vector<SourceUrdfLink> links;  ///< URDF only
  std::string extras;                 ///< glTF: what its author added to the file, as JSON; else empty
  std::vector<std::string> notes;     ///< what the reader repaired or dropped, one clause each
  std::vector<std::string>
      files;  ///< that it asked for beside itself, by the names in it; sorted, also missing ones
};

struct ReadLimits {
  std::uint64_t max_file_bytes = 512ull << 20;
  std::uint64_t memory_bytes = 4ull << 30;
  double cpu_seconds = 60;
  double wall_seconds = 90;
  int max_nodes = 20000;
  int max_depth = 1000;
};

/// Reads one file in a child process (fork, rlimits, no_new_privs, seccomp allow-list). Whatever happens
/// there comes back as one line in `error` without the file name ("not a glTF, FBX, BVH, COLLADA or URDF
/// file"). Returns false then and leaves `out` as it was.
bool read_source(const std::string& path, const ReadLimits& limits, SourceScene& out, std::string& error);

}  // namespace sinew::import
