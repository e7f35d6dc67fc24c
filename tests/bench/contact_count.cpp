// Three limp figures fall for three seconds each, for callgrind to count what contact events cost.
//
//     contact_count 0|1|2        nobody listens; begin and end; stay as well
#include <cstdio>
#include <cstdlib>

#include "character/scenes.h"
#include "sinew/character/contact_events.h"

int main(int argc, char** argv) {
  using namespace sinew;
  const int mode = argc > 1 ? std::atoi(argv[1]) : 0;
  std::vector<ContactEvent> room(4096);
  ContactRing ring(room);
  ContactReportSettings wanted;
  wanted.stay = mode > 1;
  long events = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    fixtures::Limp<float> fall({}, 0.8, 3, seed);
    if (mode > 0 && !report_contacts(fall.world, &ring, wanted)) return 1;
    for (int n = 0; n < 180; ++n) {
      if (!fall.world.step(1 / 60.f)) return 1;
      for (ContactEvent event; ring.take(event);) ++events;
    }
  }
  std::printf("%ld events\n", events);
  return 0;
}
