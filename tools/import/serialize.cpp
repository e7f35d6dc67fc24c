#include "import/serialize.h"

#include "import/bytes.h"
#include "import/scene_check.h"

namespace sinew::import {
namespace {

// One visitor per type serves both directions: `Io` is a writer or a reader.
struct Write {
  ByteWriter bytes;
  template <class T>
  bool pod(const T& v) {
    bytes.pod(v);
    return true;
  }
  bool text(const std::string& s) {
    bytes.text(s);
    return true;
  }
  template <class T>
  bool array(const std::vector<T>& v) {
    bytes.array(v);
    return true;
  }
  template <class T, class Each>
  bool list(const std::vector<T>& v, Each each) {
    bytes.pod(std::uint64_t(v.size()));
    for (const T& item : v) each(*this, item);
    return true;
  }
};

struct Read {
  ByteReader bytes;
  template <class T>
  bool pod(T& v) {
    return bytes.pod(v);
  }
  bool pod(bool& v) {  // another byte than 0 or 1 in a bool is undefined behaviour
    std::uint8_t byte = 0;
    if (!bytes.pod(byte) || byte > 1) return false;
    v = byte == 1;
    return true;
  }
  bool pod(JointType& v) { return bytes.pod(v) && v >= JointType::kFixed && v <= JointType::kFree; }
  bool pod(Shape& v) { return bytes.pod(v) && v >= Shape{} && v <= Shape::kBox; }
  bool text(std::string& s) { return bytes.text(s); }
  template <class T>
  bool array(std::vector<T>& v) {
    return bytes.array(v);
  }
  template <class T, class Each>
  bool list(std::vector<T>& v, Each each) {
    std::uint64_t n = 0;
    if (!bytes.count(n, 1)) return false;
    v.clear();
    for (std::uint64_t i = 0; i < n; ++i)
      if (!each(*this, v.emplace_back())) return false;
    return true;
  }
};

template <class Io, class Matrix>
bool matrix(Io& io, Matrix& m) {
  for (Eigen::Index i = 0; i < m.size(); ++i)
    if (!io.pod(*(m.data() + i))) return false;
  return true;
}

template <class Io, class X>
bool transform(Io& io, X& x) {
  return matrix(io, x.rotation.coeffs()) && matrix(io, x.translation);
}

template <class Io, class V>
bool vectors(Io& io, V& list) {
  return io.list(list, [](auto& i, auto& v) { return matrix(i, v); });
}

template <class Io, class V>
bool quaternions(Io& io, V& list) {
  return io.list(list, [](auto& i, auto& q) { return matrix(i, q.coeffs()); });
}

const auto node_io = [](auto& io, auto& n) {
  return io.text(n.name) && io.text(n.original_name) && io.pod(n.parent) && matrix(io, n.local) &&
         io.pod(n.is_bone);
};

const auto bone_io = [](auto& io, auto& b) {
  return io.pod(b.node) && matrix(io, b.inverse_bind) &&
         io.list(b.weights, [](auto& i, auto& w) { return i.pod(w.first) && i.pod(w.second); });
};

const auto morph_io = [](auto& io, auto& m) {
  return io.text(m.name) && io.pod(m.weight) && io.array(m.moves) && io.array(m.tilts);
};

const auto mesh_io = [](auto& io, auto& m) {
  return io.text(m.name) && io.pod(m.node) && io.array(m.positions) && io.array(m.normals) &&
         io.array(m.uvs) && io.array(m.indices) && io.list(m.bones, bone_io) && io.pod(m.material) &&
         io.list(m.morphs, morph_io);
};

const auto material_io = [](auto& io, auto& m) {
  return io.text(m.name) && io.pod(m.base_color) && io.array(m.texture);
};

const auto channel_io = [](auto& io, auto& c) {
  return io.pod(c.node) && io.array(c.position_times) && io.array(c.rotation_times) &&
         io.array(c.scale_times) && vectors(io, c.positions) && quaternions(io, c.rotations) &&
         vectors(io, c.scales);
};

const auto morph_channel_io = [](auto& io, auto& c) {
  return io.pod(c.mesh) && io.array(c.times) && io.array(c.weights);
};

const auto clip_io = [](auto& io, auto& c) {
  return io.text(c.name) && io.pod(c.duration) && io.pod(c.begin) && io.pod(c.key_rate) &&
         io.text(c.extras) && io.list(c.channels, channel_io) && io.list(c.morphs, morph_channel_io);
};

const auto reference_io = [](auto& io, auto& m) {
  return io.text(m.file) && transform(io, m.origin) && matrix(io, m.scale) && io.pod(m.color) &&
         io.pod(m.collision);
};

const auto link_io = [](auto& io, auto& l) {
  return io.text(l.name) && io.text(l.joint_name) && io.pod(l.parent) && io.pod(l.type) &&
         transform(io, l.origin) && matrix(io, l.axis) && io.pod(l.has_inertial) && io.pod(l.mass) &&
         transform(io, l.inertial_origin) && matrix(io, l.inertia) && io.pod(l.has_limits) &&
         io.pod(l.lower) && io.pod(l.upper) && io.pod(l.effort) && io.pod(l.velocity) && io.pod(l.damping) &&
         io.pod(l.friction) && io.text(l.mimic_joint) && io.pod(l.mimic_multiplier) &&
         io.pod(l.mimic_offset) && io.list(l.meshes, reference_io) && io.list(l.shapes, [](auto& i, auto& g) {
           return i.pod(g.shape) && transform(i, g.origin) && matrix(i, g.size) && i.pod(g.collision);
         });
};

template <class Io, class Scene>
bool scene_io(Io& io, Scene& s) {
  return io.text(s.format) && io.text(s.name) && io.pod(s.meters_per_unit) && io.pod(s.up_axis) &&
         io.list(s.nodes, node_io) && io.list(s.meshes, mesh_io) && io.list(s.materials, material_io) &&
         io.list(s.clips, clip_io) && io.list(s.links, link_io) && io.text(s.extras) &&
         io.list(s.notes, [](auto& i, auto& n) { return i.text(n); });
}

}  // namespace

std::string to_bytes(const SourceScene& scene) {
  Write io;
  scene_io(io, scene);
  return io.bytes.data();
}

bool from_bytes(const std::string& bytes, SourceScene& out, std::string& error) {
  SourceScene scene;
  Read io{ByteReader(bytes)};
  if (!scene_io(io, scene) || !io.bytes.done()) {
    error = "the reader's answer is damaged";
    return false;
  }
  error = fault_in(scene);
  if (!error.empty()) return false;
  out = std::move(scene);
  return true;
}

}  // namespace sinew::import
