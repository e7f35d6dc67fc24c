// A world with the standard effects. Kept apart: only programs that make such a world link them.
#include "sinew/character/contacts.h"
#include "sinew/character/world.h"
#include "sinew/effects/check_batch.h"
#include "sinew/effects/impulse.h"
#include "sinew/effects/joint_damping.h"
#include "sinew/effects/joint_limit.h"
#include "sinew/effects/muscle.h"
#include "sinew/effects/support.h"

namespace sinew {

template <class T>
World<T>::World(const WorldSettings& settings) : World(settings, DeclareNothing{}) {
  (void)declare<Muscles>();
  (void)declare<JointLimits>();
  (void)declare<JointDamping>();
  (void)declare<Impulses>();
  (void)declare<Contacts>();
  (void)declare<Support>();
  (void)declare<Batches>();
}

template World<float>::World(const WorldSettings&);
template World<double>::World(const WorldSettings&);

}  // namespace sinew
