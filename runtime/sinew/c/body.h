// BodyRef for the C interface.
#pragma once

#include "sinew/c/sinew.h"
#include "sinew/character/body_ref.h"

namespace sinew::c {

static_assert(int(BodyKind::kGround) == SINEW_BODY_GROUND &&
              int(BodyKind::kObstacle) == SINEW_BODY_OBSTACLE && int(BodyKind::kShape) == SINEW_BODY_SHAPE &&
              int(BodyKind::kCharacter) == SINEW_BODY_CHARACTER && int(BodyKind::kProp) == SINEW_BODY_PROP &&
              int(BodyKind::kParticles) == SINEW_BODY_PARTICLES);

inline sinew_body body_of(const BodyRef& body) {
  return {static_cast<sinew_body_kind>(body.kind), body.index, body.joint};
}

/// False where it is of no kind.
inline bool read_body(const sinew_body& from, BodyRef& to) {
  to = {static_cast<BodyKind>(from.kind), from.index, from.joint};
  return from.kind >= SINEW_BODY_GROUND && from.kind <= SINEW_BODY_PARTICLES;
}

}  // namespace sinew::c
