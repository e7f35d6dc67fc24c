// Assets of the C interface, and the sampling of their clips.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "sinew/animation/clip_event.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/c/call.h"
#include "sinew/c/layout.h"

namespace sinew::c {

template <>
inline constexpr std::uint32_t kFirstSize<sinew_asset_info> = 32;  // up to mass

namespace {

/// read(Asset&) makes an asset that `out` then names.
template <class Read>
sinew_status make_asset(sinew_asset* out, Read&& read) noexcept {
  if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return caught([&] {
    auto asset = std::make_shared<Asset>();
    if (const Status status = read(*asset); !status) return answer(status);
    auto owned = std::make_unique<OwnedAsset>(std::move(asset));
    const sinew_asset handle = make_handle(Kind::kAsset, owned.get());
    if (handle == 0) return fail(SINEW_OUT_OF_RANGE, kTooMany);
    static_cast<void>(owned.release());  // the handle's now
    *out = handle;
    return sinew_status(SINEW_OK);
  });
}

/// find(asset) gives the index of a name, or −1.
template <class Find>
sinew_status found(sinew_asset handle, const void* name, int32_t* out, Find&& find) noexcept {
  return with_asset(handle, [&](const Asset& asset) {
    if (!name || !out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    const int index = find(asset);
    if (index < 0) return fail(SINEW_NOT_FOUND, "the asset has nothing of that name");
    *out = index;
    return sinew_status(SINEW_OK);
  });
}

int first_dof(const Skeleton& skeleton, int joint) {
  if (joint >= skeleton.body_count) return -1;
  int dofs = 0;
  for (int j = 0; j < joint; ++j) dofs += dof_count(skeleton.joints[std::size_t(j)].type);
  return dofs;
}

constexpr const char* kNoClip = "no such clip";

}  // namespace

OwnedAsset::OwnedAsset(std::shared_ptr<const Asset> read) : asset(std::move(read)) {
  for (const Joint& joint : asset->skeleton.joints) {
    parents.push_back(joint.parent);
    rest.push_back(joint.rest.cast<float>());
  }
  LookChain<float> chain;
  if (find_look_chain(asset->skeleton, chain)) look = chain;
  mirrors = build_mirror_map<float>(asset->skeleton, mirror);
  stands = find_foot_legs<float>(asset->skeleton, legs, pelvis);
}

sinew_status sample(const Asset& asset, int clip, const ClipTime& time, std::span<JointJet<float>> jets) {
  if (clip < 0 || std::size_t(clip) >= asset.clips.size()) return fail(SINEW_INVALID_ARGUMENT, kNoClip, clip);
  return answer(SamplingJob<float>{&asset.clips[std::size_t(clip)], time, jets}.Run());
}

}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_asset_load(const char* path, sinew_asset* out) {
  if (!path) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return make_asset(out, [&](Asset& asset) { return load_asset(path, asset); });
}

sinew_status sinew_asset_read(const void* bytes, size_t size, sinew_asset* out) {
  if (!bytes) return fail(SINEW_INVALID_ARGUMENT, kNull);
  return make_asset(out, [&](Asset& asset) {
    return read_asset({static_cast<const std::uint8_t*>(bytes), size}, asset);
  });
}

sinew_status sinew_asset_destroy(sinew_asset asset) {
  const std::unique_ptr<OwnedAsset> found(static_cast<OwnedAsset*>(retire_handle(asset, Kind::kAsset)));
  return found ? sinew_status(SINEW_OK) : refuse(asset, Kind::kAsset);
}

sinew_status sinew_asset_get_info(sinew_asset asset, sinew_asset_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    return fill_sized(out, [&](sinew_asset_info& info) {
      info.joints = static_cast<int32_t>(a.skeleton.joints.size());
      info.bodies = a.skeleton.body_count;
      info.dofs = a.skeleton.dof_total();
      info.clips = static_cast<int32_t>(a.clips.size());
      info.muscles = static_cast<int32_t>(a.skeleton.muscles.size());
      info.mass = a.skeleton.total_mass();
      info.events = static_cast<int32_t>(a.event_names.size());
      info.curves = static_cast<int32_t>(a.curve_slots.size());
      info.masks = static_cast<int32_t>(a.masks.size());
    });
  });
}

sinew_status sinew_asset_get_joint(sinew_asset asset, int32_t joint, sinew_joint_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (joint < 0 || std::size_t(joint) >= a.skeleton.joints.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such joint", joint);
    return fill_sized(out, [&](sinew_joint_info& info) {
      const Joint& j = a.skeleton.joints[std::size_t(joint)];
      info.parent = j.parent;
      info.type = static_cast<sinew_joint_type>(j.type);
      info.role = static_cast<sinew_role>(j.role);
      info.name = j.name.c_str();
      info.first_dof = first_dof(a.skeleton, joint);
      info.dofs = info.first_dof < 0 ? 0 : dof_count(j.type);
      info.mass = j.mass;
    });
  });
}

sinew_status sinew_asset_get_clip(sinew_asset asset, int32_t clip, sinew_clip_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (clip < 0 || std::size_t(clip) >= a.clips.size()) return fail(SINEW_INVALID_ARGUMENT, kNoClip, clip);
    return fill_sized(out, [&](sinew_clip_info& info) {
      const Clip& c = a.clips[std::size_t(clip)];
      info.loops = c.loops;
      info.name = c.name.c_str();
      info.duration = double(c.duration);
      for (int k = 0; k < 3; ++k) info.root_step[k] = c.root_step[k];
    });
  });
}

sinew_status sinew_asset_get_muscle(sinew_asset asset, int32_t muscle, sinew_muscle_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (muscle < 0 || std::size_t(muscle) >= a.skeleton.muscles.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such muscle", muscle);
    return fill_sized(out, [&](sinew_muscle_info& info) {
      const Muscle& m = a.skeleton.muscles[std::size_t(muscle)];
      info.joint = m.joint;
      info.name = m.name.c_str();
      info.group = m.group.c_str();
    });
  });
}

sinew_status sinew_asset_find_joint(sinew_asset asset, const char* name, int32_t* out) {
  return found(asset, name, out, [&](const Asset& a) { return a.skeleton.find(name); });
}

sinew_status sinew_asset_find_role(sinew_asset asset, sinew_role role, int32_t* out) {
  if (role < SINEW_ROLE_NONE || role > SINEW_ROLE_TOES_R)
    return fail(SINEW_INVALID_ARGUMENT, "no such role", role);
  return found(asset, "", out, [&](const Asset& a) { return a.skeleton.find(Role(role)); });
}

sinew_status sinew_asset_find_clip(sinew_asset asset, const char* name, int32_t* out) {
  return found(asset, name, out, [&](const Asset& a) { return a.find_clip(name); });
}

sinew_status sinew_asset_find_muscle(sinew_asset asset, const char* name, int32_t* out) {
  return found(asset, name, out, [&](const Asset& a) { return a.skeleton.find_muscle(name); });
}

sinew_status sinew_asset_get_event(sinew_asset asset, int32_t event, sinew_event_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    if (event < 0 || std::size_t(event) >= a.event_names.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such event", event);
    return fill_sized(out, [&](sinew_event_info& info) {
      const std::string& name = a.event_names[std::size_t(event)];
      info.number = event_name(name);
      info.name = name.c_str();
    });
  });
}

sinew_status sinew_asset_find_event(sinew_asset asset, const char* name, uint32_t* out) {
  int32_t index = 0;
  if (!out) return with_asset(asset, [](const Asset&) { return fail(SINEW_INVALID_ARGUMENT, kNull); });
  const sinew_status status = found(asset, name, &index, [&](const Asset& a) {
    const auto at = std::find(a.event_names.begin(), a.event_names.end(), name);
    return at == a.event_names.end() ? -1 : static_cast<int>(at - a.event_names.begin());
  });
  if (status == SINEW_OK) *out = event_name(name);
  return status;
}

sinew_status sinew_asset_get_curve(sinew_asset asset, int32_t curve, sinew_curve_info* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (const sinew_status s = check_size(out); s != SINEW_OK) return s;
    if (curve < 0 || std::size_t(curve) >= a.curve_slots.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such curve", curve);
    return fill_sized(out, [&](sinew_curve_info& info) {
      info.rest = a.curve_slots[std::size_t(curve)].rest;
      info.name = a.curve_slots[std::size_t(curve)].name.c_str();
    });
  });
}

sinew_status sinew_asset_find_curve(sinew_asset asset, const char* name, int32_t* out) {
  return found(asset, name, out, [&](const Asset& a) { return a.find_curve(name); });
}

sinew_status sinew_asset_find_mask(sinew_asset asset, const char* name, int32_t* out) {
  return found(asset, name, out, [&](const Asset& a) { return a.find_mask(name); });
}

sinew_status sinew_asset_get_mask(sinew_asset asset, int32_t mask, float* out, int32_t capacity,
                                  int32_t* count) {
  return with_asset(asset, [&](const Asset& a) {
    if (!count || (!out && capacity != 0)) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (mask < 0 || std::size_t(mask) >= a.masks.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such mask", mask);
    const std::size_t joints = a.skeleton.joints.size();
    *count = static_cast<int32_t>(joints);
    if (capacity < *count) return fail(SINEW_TOO_SMALL, "room for fewer joints than the skeleton has");
    a.masks[std::size_t(mask)].write(std::span(out, joints));
    return sinew_status(SINEW_OK);
  });
}

sinew_status sinew_clip_sample(sinew_asset asset, int32_t clip, double time, double rate, double rate_change,
                               sinew_jet* jets, int32_t count) {
  return with_asset(asset, [&](const Asset& a) {
    if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
    if (count < 0 || std::size_t(count) > a.skeleton.joints.size())
      return fail(SINEW_INVALID_ARGUMENT, "more jets than the skeleton has joints, or fewer than none",
                  count);
    return sample(a, clip, {time, rate, rate_change}, jets_of(jets, count));
  });
}

sinew_status sinew_clip_in_contact(sinew_asset asset, int32_t clip, double time, int32_t joint,
                                   int32_t* out) {
  return with_asset(asset, [&](const Asset& a) {
    if (!out) return fail(SINEW_INVALID_ARGUMENT, kNull);
    if (!std::isfinite(time)) return fail(SINEW_NOT_FINITE, "time must be finite");
    if (clip < 0 || std::size_t(clip) >= a.clips.size()) return fail(SINEW_INVALID_ARGUMENT, kNoClip, clip);
    if (joint < 0 || std::size_t(joint) >= a.skeleton.joints.size())
      return fail(SINEW_INVALID_ARGUMENT, "no such joint", joint);
    *out = in_contact(a.clips[std::size_t(clip)], time, joint);
    return sinew_status(SINEW_OK);
  });
}
