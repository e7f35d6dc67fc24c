#include "study/talk/talk.h"

#include "study/talk/judges.h"

namespace sinew::study {

std::vector<Situation> talk_scenes() {
  std::vector<Situation> all = talk_mechanisms();
  for (const Situation& s : talk_characters()) all.push_back(s);
  return all;
}

}  // namespace sinew::study
