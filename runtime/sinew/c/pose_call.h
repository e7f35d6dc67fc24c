// What calls of the C interface for jets in the caller's memory share.
#pragma once

#include <cstddef>
#include <span>

#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/c/layout.h"

namespace sinew::c {

/// Whether `jets` can be those of the first joints of a skeleton.
inline sinew_status check_jets(const OwnedAsset& owned, const sinew_jet* jets, int count) noexcept {
  if (!jets) return fail(SINEW_INVALID_ARGUMENT, kNull);
  if (!aligned(jets)) return fail(SINEW_INVALID_ARGUMENT, kMisaligned);
  if (count < 0 || std::size_t(count) > owned.parents.size())
    return fail(SINEW_INVALID_ARGUMENT, "more jets than the skeleton has joints, or fewer than none", count);
  return SINEW_OK;
}

/// The numbers of a state that the caller keeps, one after the other beside those that have names here:
/// copy(number there, number here) takes them either way.
template <class Number, class Copy>
struct NumberList {
  Number* next;
  Copy& copy;

  void number(auto& x) { copy(*next++, x); }
  void jet(auto& x) {
    number(x.value);
    number(x.rate);
    number(x.acceleration);
  }
};
template <class Number, class Copy>
NumberList(Number*, Copy&) -> NumberList<Number, Copy>;

/// job(const OwnedAsset&, const S& settings, jets) → status, with what the caller set.
template <class S, class C, class List, class Job>
sinew_status run(sinew_asset asset, const C* settings, List&& list, sinew_jet* jets, int count,
                 Job&& job) noexcept {
  return with_owned_asset(asset, [&](const OwnedAsset& owned) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    S read;
    if (const sinew_status s = read_settings(settings, read, list); s != SINEW_OK) return s;
    if (const sinew_status s = check_jets(owned, jets, count); s != SINEW_OK) return s;
    return job(owned, read, jets_of(jets, count));
  });
}

}  // namespace sinew::c
