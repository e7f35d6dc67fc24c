#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "sinew/animation/clip_packing.h"
#include "sinew/io/asset.h"
#include "sinew/io/mapped_file.h"
#include "sinew/io/schema_version.h"
#include "sinew_generated.h"

namespace sinew {
namespace {

constexpr int kMaxDepth = 64;  ///< of nested tables; the schema needs 4
constexpr int kMaxTables = 1'000'000;
constexpr std::size_t kMaxJoints = 100'000;
constexpr std::size_t kMostNames = 1024;

Status bad(const char* reason, int index = -1) {
  return Status::error(Code::kBadFile, reason, index);
}

Vec3<double> unpack(const fb::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Transform<double> unpack(const fb::Transform& x) {
  const fb::Quat& q = x.rotation();
  return {Quat<double>(q.w(), q.x(), q.y(), q.z()), unpack(x.translation())};
}

Transform<float> unpack(const fb::TransformF& x) {
  return {Quat<float>(x.qw(), x.qx(), x.qy(), x.qz()), {x.x(), x.y(), x.z()}};
}

template <class Value>
std::vector<Value> copied(const flatbuffers::Vector<Value>* v) {
  return v ? std::vector<Value>(v->begin(), v->end()) : std::vector<Value>();
}

template <class Value>
std::size_t size_of(const flatbuffers::Vector<Value>* v) {
  return v ? v->size() : 0;
}

Status unpack(const fb::Joint& in, int index, Joint& out) {
  if (in.type() > static_cast<int>(JointType::kFree)) return bad("unknown joint type", index);
  if (in.role() > static_cast<int>(Role::kToesR)) return bad("unknown joint role", index);
  if (in.inertia()->size() != 9 || in.dofs()->size() != 6)
    return bad("inertia or limits have the wrong size", index);
  out.name = in.name()->str();
  if (in.source_joint()) out.source_joint = in.source_joint()->str();
  out.parent = in.parent();
  out.type = static_cast<JointType>(in.type());
  out.role = static_cast<Role>(in.role());
  out.rest = unpack(*in.rest());
  out.axis = unpack(*in.axis());
  out.axis2 = unpack(*in.axis2());
  out.mass = in.mass();
  out.center_of_mass = unpack(*in.center_of_mass());
  for (unsigned k = 0; k < 9; ++k) out.inertia(k / 3, k % 3) = in.inertia()->Get(k);
  for (unsigned k = 0; k < 6; ++k) {
    const fb::Dof& d = *in.dofs()->Get(k);
    out.dofs[k] = {d.lower(), d.upper(), d.torque_minus(), d.torque_plus(), d.damping(), d.dry_friction()};
  }
  out.swing_limit = in.swing_limit();
  out.swing_axis = unpack(*in.swing_axis());
  out.twist_lower = in.twist_lower();
  out.twist_upper = in.twist_upper();
  out.ellipsoidal_limit = in.ellipsoidal_limit();
  if (std::isnan(out.swing_limit) || std::isnan(out.twist_lower) || std::isnan(out.twist_upper))
    return bad("swing or twist limit is NaN", index);
  return {};
}

Status unpack(const fb::Skeleton& in, Skeleton& out) {
  if (in.joints()->size() > kMaxJoints) return bad("too many joints");
  out.name = in.name()->str();
  out.body_count = in.body_count();
  for (unsigned i = 0; i < in.joints()->size(); ++i)
    if (Status status = unpack(*in.joints()->Get(i), static_cast<int>(i), out.joints.emplace_back()); !status)
      return status;
  for (unsigned i = 0; i < size_of(in.colliders()); ++i) {
    const fb::Collider& c = *in.colliders()->Get(i);
    if (c.shape() > static_cast<int>(Shape::kBox)) return bad("unknown collider shape", c.joint());
    out.colliders.push_back(
        {c.joint(), static_cast<Shape>(c.shape()), unpack(c.local()), unpack(c.size()), c.friction()});
  }
  for (unsigned i = 0; i < size_of(in.muscles()); ++i) {
    const fb::Muscle& m = *in.muscles()->Get(i);
    out.muscles.push_back({m.name()->str(), m.group() ? m.group()->str() : std::string(), m.joint(), m.dof(),
                           m.torque_minus(), m.torque_plus()});
  }
  return validate(out);
}

/// All of them, or the skeleton's rest where the clip says nothing else.
Status unpack_constants(const fb::Clip& in, const Skeleton& skeleton, std::vector<Transform<float>>& out) {
  if (in.constants()) {
    for (const fb::TransformF* c : *in.constants()) out.push_back(unpack(*c));
  } else {
    for (const Joint& joint : skeleton.joints) out.push_back(joint.rest.cast<float>());
  }
  if (out.size() != skeleton.joints.size()) return bad("clip has another number of joints than the skeleton");
  for (unsigned k = 0; k < size_of(in.still_rotations()); ++k) {
    const fb::StillRotation& r = *in.still_rotations()->Get(k);
    if (r.joint() >= out.size()) return bad("clip holds a joint that does not exist", r.joint());
    out[r.joint()].rotation = Quat<float>(r.w(), r.x(), r.y(), r.z());
  }
  for (unsigned k = 0; k < size_of(in.still_translations()); ++k) {
    const fb::StillTranslation& t = *in.still_translations()->Get(k);
    if (t.joint() >= out.size()) return bad("clip holds a joint that does not exist", t.joint());
    out[t.joint()].translation = {t.x(), t.y(), t.z()};
  }
  return {};
}

Status unpack(const fb::Group& in, Clip::Group& out) {
  out.rotation = in.rotation();
  out.degree = in.degree();
  out.knot_interval = in.knot_interval();
  out.control_count = in.control_count();
  if (in.packed()) return unpack_group({in.packed()->data(), in.packed()->size()}, out);
  if (!in.joints() || !in.controls()) return bad("clip has a group without controls");
  for (const int joint : *in.joints()) out.tracks.push_back({joint});
  out.controls = copied(in.controls());
  return {};
}

using EventNames = std::vector<std::uint32_t>;  ///< as event_name() numbers them

Status unpack_events(const fb::Clip& in, const EventNames& names, Clip& out) {
  for (unsigned k = 0; k < size_of(in.events()); ++k) {
    const fb::Event& e = *in.events()->Get(k);
    if (e.name() >= names.size()) return bad("event has no name", static_cast<int>(k));
    ClipEvent& event = out.events.emplace_back();
    event.begin = e.begin();
    event.end = e.end();
    event.name = names[e.name()];
    event.always = e.always();
    if (!e.payload()) continue;
    if (e.payload()->size() != event.payload.size())
      return bad("payload of an event has another size", static_cast<int>(k));
    std::memcpy(event.payload.data(), e.payload()->data(), event.payload.size());
  }
  return {};
}

Status unpack(const fb::Clip& in, const Skeleton& skeleton, const EventNames& names, Clip& out) {
  out.name = in.name()->str();
  out.duration = in.duration();
  out.loops = in.loops();
  out.joint_count = static_cast<int>(skeleton.joints.size());
  if (Status status = unpack_constants(in, skeleton, out.constants); !status) return status;
  if (in.root_step()->size() != 3) return bad("root step needs three numbers");
  out.root_step = {in.root_step()->Get(0), in.root_step()->Get(1), in.root_step()->Get(2)};
  for (unsigned g = 0; g < size_of(in.groups()); ++g)
    if (Status status = unpack(*in.groups()->Get(g), out.groups.emplace_back()); !status) return status;
  for (unsigned k = 0; k < size_of(in.contacts()); ++k) {
    const fb::Contact& c = *in.contacts()->Get(k);
    out.contacts.push_back({c.joint(), c.begin(), c.end()});
  }
  for (unsigned k = 0; k < size_of(in.curves()); ++k) {
    const fb::Curve& c = *in.curves()->Get(k);
    out.curves.push_back({c.slot(), c.knot_interval(), copied(c.controls())});
  }
  if (Status status = unpack_events(in, names, out); !status) return status;
  for (unsigned k = 0; k < size_of(in.markers()); ++k)
    out.markers.push_back({in.markers()->Get(k)->phase(), in.markers()->Get(k)->time()});
  out.cycles = in.cycles();
  return validate(out);
}

EventNames numbers_of(const std::vector<std::string>& names) {
  EventNames numbers;
  for (const std::string& name : names) numbers.push_back(event_name(name));
  return numbers;
}

/// The place of a key that comes a second time, or −1.
template <class Key>
int repeated(const std::vector<Key>& keys) {
  std::vector<std::pair<Key, int>> sorted;
  for (std::size_t k = 0; k < keys.size(); ++k) sorted.emplace_back(keys[k], static_cast<int>(k));
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end(),
                                        [](const auto& a, const auto& b) { return a.first == b.first; });
  return twice == sorted.end() ? -1 : (twice + 1)->second;
}

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.push_back(item.name);
  return names;
}

/// Whether a target moves vertices that are there, each once, by as many numbers as they have.
bool is_of_mesh(const MorphTarget& target, std::size_t vertices) {
  std::size_t touched = 0, next = 0;
  for (const MorphRun& run : target.runs) {
    if (run.count == 0 || run.first < next || run.first >= vertices || run.count > vertices - run.first)
      return false;
    next = std::size_t(run.first) + run.count;
    touched += run.count;
  }
  return target.moves.size() == 3 * touched && (target.tilts.empty() || target.tilts.size() == 3 * touched) &&
         std::isfinite(target.scale) && std::isfinite(target.tilt_scale);
}

Status unpack(const fb::MorphTarget& in, std::size_t vertices, int slots, int index, Mesh& out) {
  MorphTarget& target = out.morphs.emplace_back();
  for (unsigned k = 0; k < in.runs()->size(); ++k)
    target.runs.push_back({in.runs()->Get(k)->first(), in.runs()->Get(k)->count()});
  target.moves = copied(in.moves());
  target.tilts = copied(in.tilts());
  target.scale = in.scale();
  target.tilt_scale = in.tilt_scale();
  out.morph_curves.push_back(in.curve());
  if (!is_of_mesh(target, vertices)) return bad("mesh has a morph target of other vertices", index);
  if (in.curve() < 0 || in.curve() >= slots) return bad("mesh has a morph target without a curve", index);
  return {};
}

Status unpack(const fb::Mesh& in, int joints, int materials, int slots, int index, Mesh& out) {
  out.name = in.name()->str();
  out.positions = copied(in.positions());
  out.normals = copied(in.normals());
  out.uvs = copied(in.uvs());
  out.indices = copied(in.indices());
  out.joints = copied(in.joints());
  out.weights = copied(in.weights());
  out.material = in.material();
  const std::size_t vertices = out.positions.size() / 3;
  if (out.positions.size() != 3 * vertices || out.normals.size() != 3 * vertices ||
      (!out.uvs.empty() && out.uvs.size() != 2 * vertices) ||
      (!out.joints.empty() && (out.joints.size() != 4 * vertices || out.weights.size() != 4 * vertices)))
    return bad("mesh arrays disagree in length", index);
  if (out.indices.size() % 3 != 0) return bad("mesh indices are not triangles", index);
  for (const std::uint32_t i : out.indices)
    if (i >= vertices) return bad("mesh index out of range", index);
  for (const std::uint16_t j : out.joints)
    if (j >= joints) return bad("mesh influence of a joint that does not exist", index);
  for (const std::vector<float>* values : {&out.positions, &out.normals, &out.uvs, &out.weights})
    for (const float v : *values)
      if (!std::isfinite(v)) return bad("mesh has a number that is not finite", index);
  if (out.material < -1 || out.material >= materials)
    return bad("mesh names a material that does not exist", index);
  for (unsigned k = 0; k < size_of(in.morphs()); ++k)
    if (Status status = unpack(*in.morphs()->Get(k), vertices, slots, index, out); !status) return status;
  return {};
}

}  // namespace

namespace {

template <class List>
int find_name(const List& list, const std::string& name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

}  // namespace

int Asset::find_clip(const std::string& name) const {
  return find_name(clips, name);
}

int Asset::find_curve(const std::string& name) const {
  return find_name(curve_slots, name);
}

int Asset::find_mask(const std::string& name) const {
  return find_name(masks, name);
}

Status validate_names(const Asset& asset) {
  if (asset.curve_slots.size() > kMostNames || asset.event_names.size() > kMostNames ||
      asset.masks.size() > kMostNames)
    return bad("more than 1024 curves, events or masks");
  EventNames numbers = numbers_of(asset.event_names);
  if (const int k = repeated(names_of(asset.curve_slots)); k >= 0) return bad("two curves have one name", k);
  if (const int k = repeated(names_of(asset.masks)); k >= 0) return bad("two masks have one name", k);
  if (const int k = repeated(numbers); k >= 0)
    return bad("two events have one name, or names of one number", k);
  std::sort(numbers.begin(), numbers.end());
  for (std::size_t k = 0; k < asset.curve_slots.size(); ++k)
    if (!std::isfinite(asset.curve_slots[k].rest)) return bad("curve rests nowhere", static_cast<int>(k));
  for (std::size_t k = 0; k < asset.masks.size(); ++k)
    if (asset.masks[k].weights.size() != asset.skeleton.joints.size())
      return bad("mask has another number of joints than the skeleton", static_cast<int>(k));
  for (std::size_t c = 0; c < asset.clips.size(); ++c) {
    const Clip& clip = asset.clips[c];
    if (!clip.curves.empty() && static_cast<std::size_t>(clip.curves.back().slot) >= asset.curve_slots.size())
      return bad("clip moves a curve that does not exist", static_cast<int>(c));
    for (const ClipEvent& event : clip.events)
      if (!std::binary_search(numbers.begin(), numbers.end(), event.name))
        return bad("clip has an event without a name", static_cast<int>(c));
  }
  return {};
}

Status read_asset(std::span<const std::uint8_t> bytes, Asset& out) {
  if (bytes.size() < 16) return bad("too short for a Sinew asset");
  if (bytes.size() > std::size_t(std::numeric_limits<std::int32_t>::max())) return bad("larger than 2 GiB");
  if (!fb::AssetBufferHasIdentifier(bytes.data())) return bad("not a Sinew asset");
  flatbuffers::Verifier verifier(bytes.data(), bytes.size(), kMaxDepth, kMaxTables);
  if (!fb::VerifyAssetBuffer(verifier)) return bad("truncated or damaged");
  const fb::Asset& in = *fb::GetAsset(bytes.data());
  if (in.schema_major() > kSchemaMajor)
    return Status::error(Code::kBadVersion, "written by a newer version of Sinew");
  if (in.schema_major() < 1) return bad("has no version");

  Asset asset;
  if (Status status = unpack(*in.skeleton(), asset.skeleton); !status) return status;
  const int joints = static_cast<int>(asset.skeleton.joints.size());
  if (size_of(in.event_names()) > kMostNames) return bad("too many events");
  for (unsigned i = 0; i < size_of(in.event_names()); ++i)
    asset.event_names.push_back(in.event_names()->Get(i)->str());
  const EventNames names = numbers_of(asset.event_names);
  for (unsigned i = 0; i < size_of(in.clips()); ++i)
    if (Status status = unpack(*in.clips()->Get(i), asset.skeleton, names, asset.clips.emplace_back());
        !status)
      return status;
  for (unsigned i = 0; i < size_of(in.curve_slots()); ++i)
    asset.curve_slots.push_back({in.curve_slots()->Get(i)->name()->str(), in.curve_slots()->Get(i)->rest()});
  for (unsigned i = 0; i < size_of(in.masks()); ++i)
    asset.masks.push_back({in.masks()->Get(i)->name()->str(), copied(in.masks()->Get(i)->weights())});
  if (Status status = validate_names(asset); !status) return status;
  for (unsigned i = 0; i < size_of(in.materials()); ++i) {
    const fb::Material& m = *in.materials()->Get(i);
    Material& material = asset.materials.emplace_back();
    material.name = m.name()->str();
    if (m.base_color()->size() != 4) return bad("material colour needs four numbers", static_cast<int>(i));
    for (unsigned k = 0; k < 4; ++k) {
      material.base_color[k] = m.base_color()->Get(k);
      if (!std::isfinite(material.base_color[k]))
        return bad("material colour is not finite", static_cast<int>(i));
    }
    material.texture = copied(m.texture());
  }
  const int materials = static_cast<int>(asset.materials.size());
  for (unsigned i = 0; i < size_of(in.meshes()); ++i)
    if (Status status =
            unpack(*in.meshes()->Get(i), joints, materials, static_cast<int>(asset.curve_slots.size()),
                   static_cast<int>(i), asset.meshes.emplace_back());
        !status)
      return status;
  for (unsigned i = 0; i < size_of(in.inverse_bind()); ++i) {
    asset.inverse_bind.push_back(unpack(*in.inverse_bind()->Get(i)));
    const Transform<float>& x = asset.inverse_bind.back();
    if (!x.rotation.coeffs().allFinite() || !x.translation.allFinite())
      return bad("bind pose is not finite", static_cast<int>(i));
  }
  if (!asset.inverse_bind.empty() && asset.inverse_bind.size() != asset.skeleton.joints.size())
    return bad("bind pose has another number of joints than the skeleton");
  if (asset.inverse_bind.empty())
    for (const Mesh& mesh : asset.meshes)
      if (!mesh.joints.empty()) return bad("skinned mesh without a bind pose");
  if (in.report_json()) asset.report_json = in.report_json()->str();
  out = std::move(asset);
  return {};
}

Status load_asset(const char* path, Asset& out) {
  MappedFile file;
  if (Status status = file.open(path); !status) return status;
  return read_asset(file.bytes(), out);
}

}  // namespace sinew
