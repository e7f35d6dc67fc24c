#include <algorithm>

#include "sinew/animation/clip_packing.h"
#include "sinew/io/asset.h"
#include "sinew/io/schema_version.h"
#include "sinew_generated.h"

namespace sinew {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

fb::Vec3 pack(const Vec3<double>& v) {
  return {v.x(), v.y(), v.z()};
}

fb::Transform pack(const Transform<double>& x) {
  const Quat<double>& q = x.rotation;
  return {fb::Quat(q.x(), q.y(), q.z(), q.w()), pack(x.translation)};
}

fb::TransformF pack(const Transform<float>& x) {
  const Quat<float>& q = x.rotation;
  const Vec3<float>& t = x.translation;
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

Offset<fb::Joint> pack(FlatBufferBuilder& b, const Joint& joint) {
  const auto name = b.CreateString(joint.name), source = b.CreateString(joint.source_joint);
  std::vector<double> inertia;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) inertia.push_back(joint.inertia(r, c));
  std::vector<fb::Dof> dofs;
  for (const DofLimits& d : joint.dofs)
    dofs.emplace_back(d.lower, d.upper, d.torque_minus, d.torque_plus, d.damping, d.dry_friction);
  const auto inertia_offset = b.CreateVector(inertia);
  const auto dofs_offset = b.CreateVectorOfStructs(dofs);
  const fb::Transform rest = pack(joint.rest);
  const fb::Vec3 axis = pack(joint.axis), axis2 = pack(joint.axis2), center = pack(joint.center_of_mass),
                 swing = pack(joint.swing_axis);
  return fb::CreateJoint(b, name, source, joint.parent, static_cast<std::uint8_t>(joint.type),
                         static_cast<std::uint8_t>(joint.role), &rest, &axis, &axis2, joint.mass, &center,
                         inertia_offset, dofs_offset, joint.swing_limit, &swing, joint.twist_lower,
                         joint.twist_upper, joint.ellipsoidal_limit);
}

Offset<fb::Skeleton> pack(FlatBufferBuilder& b, const Skeleton& skeleton) {
  std::vector<Offset<fb::Joint>> joints;
  for (const Joint& joint : skeleton.joints) joints.push_back(pack(b, joint));
  std::vector<fb::Collider> colliders;
  for (const Collider& c : skeleton.colliders)
    if (c.shape != Shape::kConvex)
      colliders.emplace_back(c.joint, static_cast<std::uint8_t>(c.shape), c.friction, pack(c.local),
                             pack(c.size));
  const auto name = b.CreateString(skeleton.name);
  const auto joints_offset = b.CreateVector(joints);
  const auto colliders_offset = b.CreateVectorOfStructs(colliders);
  std::vector<Offset<fb::Muscle>> muscles;
  for (const Muscle& m : skeleton.muscles) {
    const auto muscle_name = b.CreateString(m.name), group = b.CreateString(m.group);
    muscles.push_back(fb::CreateMuscle(b, muscle_name, group, m.joint, m.dof, m.torque_minus, m.torque_plus));
  }
  const auto muscles_offset = b.CreateVector(muscles);
  return fb::CreateSkeleton(b, name, skeleton.body_count, joints_offset, colliders_offset, muscles_offset);
}

Offset<fb::Group> pack(FlatBufferBuilder& b, const Clip::Group& group) {
  std::vector<std::uint8_t> bytes;
  if (pack_group(group, bytes)) {
    const auto packed = b.CreateVector(bytes);
    return fb::CreateGroup(b, group.rotation, group.degree, group.knot_interval, group.control_count, 0, 0,
                           packed);
  }
  std::vector<int> joints;
  for (const Clip::Track& track : group.tracks) joints.push_back(track.joint);
  const auto joints_offset = b.CreateVector(joints);
  const auto controls = b.CreateVector(group.controls);
  return fb::CreateGroup(b, group.rotation, group.degree, group.knot_interval, group.control_count,
                         joints_offset, controls);
}

/// What joints without a track keep, where it is not their rest.
void pack_constants(const Clip& clip, const Skeleton& skeleton, std::vector<fb::StillRotation>& rotations,
                    std::vector<fb::StillTranslation>& translations) {
  for (std::size_t j = 0; j < clip.constants.size(); ++j) {
    const Transform<float>& x = clip.constants[j];
    const Transform<float> rest = skeleton.joints[j].rest.cast<float>();
    const auto joint = static_cast<std::uint16_t>(j);
    if (x.rotation != rest.rotation)
      rotations.emplace_back(joint, x.rotation.x(), x.rotation.y(), x.rotation.z(), x.rotation.w());
    if (x.translation != rest.translation)
      translations.emplace_back(joint, x.translation.x(), x.translation.y(), x.translation.z());
  }
}

using Names = std::vector<std::string>;

/// Absent where the clip has none: then it takes no bytes.
template <class Table>
Offset<flatbuffers::Vector<Offset<Table>>> list(FlatBufferBuilder& b,
                                                const std::vector<Offset<Table>>& tables) {
  return tables.empty() ? Offset<flatbuffers::Vector<Offset<Table>>>() : b.CreateVector(tables);
}

Offset<flatbuffers::Vector<Offset<fb::Curve>>> pack_curves(FlatBufferBuilder& b, const Clip& clip) {
  std::vector<Offset<fb::Curve>> curves;
  for (const FloatCurve& c : clip.curves)
    curves.push_back(fb::CreateCurve(b, c.slot, c.knot_interval, b.CreateVector(c.controls)));
  return list(b, curves);
}

Offset<flatbuffers::Vector<Offset<fb::Event>>> pack_events(FlatBufferBuilder& b, const Clip& clip,
                                                           const Names& names) {
  std::vector<Offset<fb::Event>> events;
  for (const ClipEvent& e : clip.events) {
    const auto name = std::find_if(names.begin(), names.end(),
                                   [&](const std::string& text) { return event_name(text) == e.name; });
    if (name == names.end()) continue;
    Offset<flatbuffers::Vector<std::uint8_t>> payload;
    if (e.payload != decltype(e.payload){})
      payload = b.CreateVector(reinterpret_cast<const std::uint8_t*>(e.payload.data()), e.payload.size());
    events.push_back(fb::CreateEvent(b, static_cast<std::uint16_t>(name - names.begin()), e.begin, e.end,
                                     e.always, payload));
  }
  return list(b, events);
}

Offset<fb::Clip> pack(FlatBufferBuilder& b, const Clip& clip, const Skeleton& skeleton, const Names& names) {
  const bool few_joints = skeleton.joints.size() == clip.constants.size() && clip.constants.size() <= 0xffff;
  std::vector<fb::TransformF> constants;
  std::vector<fb::StillRotation> rotations;
  std::vector<fb::StillTranslation> translations;
  if (few_joints)
    pack_constants(clip, skeleton, rotations, translations);
  else
    for (const Transform<float>& c : clip.constants) constants.push_back(pack(c));
  std::vector<Offset<fb::Group>> groups;
  for (const Clip::Group& group : clip.groups) groups.push_back(pack(b, group));
  std::vector<fb::Contact> contacts;
  for (const ContactWindow& c : clip.contacts) contacts.emplace_back(c.joint, c.begin, c.end);
  const auto name = b.CreateString(clip.name);
  const auto constants_offset =
      few_joints ? Offset<flatbuffers::Vector<const fb::TransformF*>>() : b.CreateVectorOfStructs(constants);
  const auto rotations_offset = b.CreateVectorOfStructs(rotations);
  const auto translations_offset = b.CreateVectorOfStructs(translations);
  const auto groups_offset = b.CreateVector(groups);
  const auto contacts_offset = b.CreateVectorOfStructs(contacts);
  const auto step = b.CreateVector(clip.root_step.data(), 3);
  const auto curves = pack_curves(b, clip);
  const auto events = pack_events(b, clip, names);
  Offset<flatbuffers::Vector<const fb::Marker*>> markers;
  if (!clip.markers.empty()) {
    std::vector<fb::Marker> all;
    for (const PhaseMarker& m : clip.markers) all.emplace_back(m.phase, m.time);
    markers = b.CreateVectorOfStructs(all);
  }
  return fb::CreateClip(b, name, clip.duration, clip.loops, constants_offset, groups_offset, contacts_offset,
                        step, rotations_offset, translations_offset, curves, events, markers, clip.cycles);
}

Offset<fb::MorphTarget> pack(FlatBufferBuilder& b, const MorphTarget& target, int curve) {
  std::vector<fb::MorphRun> runs;
  for (const MorphRun& run : target.runs) runs.emplace_back(run.first, run.count);
  const auto runs_offset = b.CreateVectorOfStructs(runs);
  const auto moves = b.CreateVector(target.moves);
  const auto tilts =
      target.tilts.empty() ? Offset<flatbuffers::Vector<std::int16_t>>() : b.CreateVector(target.tilts);
  return fb::CreateMorphTarget(b, curve, runs_offset, moves, target.scale, tilts, target.tilt_scale);
}

Offset<fb::Mesh> pack(FlatBufferBuilder& b, const Mesh& mesh) {
  const auto name = b.CreateString(mesh.name);
  const auto positions = b.CreateVector(mesh.positions), normals = b.CreateVector(mesh.normals),
             uvs = b.CreateVector(mesh.uvs);
  const auto indices = b.CreateVector(mesh.indices);
  const auto joints = b.CreateVector(mesh.joints);
  const auto weights = b.CreateVector(mesh.weights);
  std::vector<Offset<fb::MorphTarget>> targets;
  for (std::size_t k = 0; k < mesh.morphs.size(); ++k)
    targets.push_back(pack(b, mesh.morphs[k], k < mesh.morph_curves.size() ? mesh.morph_curves[k] : -1));
  using Targets = flatbuffers::Vector<Offset<fb::MorphTarget>>;
  const auto morphs = targets.empty() ? Offset<Targets>() : b.CreateVector(targets);
  return fb::CreateMesh(b, name, positions, normals, uvs, indices, joints, weights, mesh.material, morphs);
}

}  // namespace

std::vector<std::uint8_t> write_asset(const Asset& asset) {
  FlatBufferBuilder b(1 << 20);
  b.ForceDefaults(true);
  const auto skeleton = pack(b, asset.skeleton);
  std::vector<Offset<fb::Clip>> clips;
  for (const Clip& clip : asset.clips) clips.push_back(pack(b, clip, asset.skeleton, asset.event_names));
  std::vector<Offset<fb::Mesh>> meshes;
  for (const Mesh& mesh : asset.meshes) meshes.push_back(pack(b, mesh));
  std::vector<Offset<fb::Material>> materials;
  for (const Material& material : asset.materials) {
    const auto name = b.CreateString(material.name);
    const auto color = b.CreateVector(material.base_color, 4);
    const auto texture = b.CreateVector(material.texture);
    materials.push_back(fb::CreateMaterial(b, name, color, texture));
  }
  std::vector<fb::TransformF> bind;
  for (const Transform<float>& x : asset.inverse_bind) bind.push_back(pack(x));
  const auto clips_offset = b.CreateVector(clips);
  const auto meshes_offset = b.CreateVector(meshes);
  const auto materials_offset = b.CreateVector(materials);
  const auto bind_offset = b.CreateVectorOfStructs(bind);
  const auto report = b.CreateString(asset.report_json);
  std::vector<Offset<fb::CurveSlot>> slots;
  for (const CurveSlot& slot : asset.curve_slots)
    slots.push_back(fb::CreateCurveSlot(b, b.CreateString(slot.name), slot.rest));
  std::vector<Offset<fb::Mask>> masks;
  for (const JointMask& mask : asset.masks) {
    const auto name = b.CreateString(mask.name);
    masks.push_back(fb::CreateMask(b, name, b.CreateVector(mask.weights)));
  }
  const auto slots_offset = b.CreateVector(slots);
  const auto names_offset = b.CreateVectorOfStrings(asset.event_names);
  const auto masks_offset = b.CreateVector(masks);
  b.Finish(fb::CreateAsset(b, kSchemaMajor, kSchemaMinor, skeleton, clips_offset, meshes_offset,
                           materials_offset, bind_offset, report, slots_offset, names_offset, masks_offset),
           fb::AssetIdentifier());
  return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

std::size_t file_bytes(const Clip& clip, const Skeleton& skeleton) {
  FlatBufferBuilder b;
  b.ForceDefaults(true);
  pack(b, clip, skeleton, {});
  return b.GetSize();
}

}  // namespace sinew
