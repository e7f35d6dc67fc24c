#include "study/tables/peers/families.h"

namespace sinew::study {

std::vector<Peer> peers() {
  std::vector<Peer> all = simbody_peers();
  for (const std::vector<Peer>& family : {sundials_peers(), odeint_peers()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

}  // namespace sinew::study
