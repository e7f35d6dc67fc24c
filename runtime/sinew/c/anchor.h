// Anchor for the C interface.
#pragma once

#include "sinew/c/call.h"
#include "sinew/effects/coupling.h"

namespace sinew::c {

/// What an anchor hangs on; its frame is read already.
inline sinew_status find_anchor(sinew_world world, const sinew_anchor& from, Anchor& to) {
  if (from.kind == SINEW_ANCHOR_WORLD) return SINEW_OK;
  const Kind kind = from.kind == SINEW_ANCHOR_CHARACTER ? Kind::kCharacter : Kind::kProp;
  if (kind == Kind::kProp && from.kind != SINEW_ANCHOR_PROP)
    return fail(SINEW_INVALID_ARGUMENT, "no such kind of anchor", from.kind);
  if (!find_object(from.handle, kind)) return refuse(from.handle, kind);
  if (world_of(from.handle) != world) return fail(SINEW_INVALID_ARGUMENT, "the anchor is in another world");
  to.kind = kind == Kind::kCharacter ? AnchorKind::kCharacter : AnchorKind::kProp;
  to.index = index_of(from.handle);
  to.joint = from.joint;
  return SINEW_OK;
}

}  // namespace sinew::c
