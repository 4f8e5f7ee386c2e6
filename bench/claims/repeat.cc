// `claims repeat`: the same run twice, to the bit.

#include <cstdio>

#include "bench/claims/claims.h"
#include "bench/trial.h"

namespace regrasp::claims {

int Repeat(const Options& o) {
  std::uint64_t hash[2];
  for (std::uint64_t& h : hash) {
    Session session(MakeConfig(o, o.first, o.object));
    GraspObject(session);
    const int ticks = static_cast<int>(o.seconds * 1000);
    while (session.tick() < ticks) {
      session.Tick();
      session.TakeEvents();
    }
    h = session.StateHash();
    std::printf("state hash after %.0f s: %016llx (%s)\n", o.seconds,
                static_cast<unsigned long long>(h), Name(session.state()).data());
  }
  return hash[0] == hash[1] ? 0 : 1;
}

}  // namespace regrasp::claims
