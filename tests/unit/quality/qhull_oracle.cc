#include "tests/unit/quality/qhull_oracle.h"

#include <algorithm>
#include <cstdio>

// The C interface: qhull's C++ headers of this version do not compile as C++20.
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace regrasp::test {

QhullAnswer RunQhull(const std::vector<Wrench>& points) {
  std::vector<double> coordinates;
  for (const Wrench& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 6);
  std::FILE* silence = std::fopen("/dev/null", "w");
  qhT qh;
  qh_zero(&qh, silence);
  char options[] = "qhull Qt";
  QhullAnswer answer;
  if (qh_new_qhull(&qh, 6, static_cast<int>(points.size()), coordinates.data(), 0, options, nullptr,
                   silence) == 0) {
    answer.ok = true;
    answer.least_offset = 1e9;
    for (const facetT* f = qh.facet_list; f && f->next; f = f->next)
      answer.least_offset = std::min(answer.least_offset, -f->offset);
    qh_getarea(&qh, qh.facet_list);
    answer.volume = qh.totvol;
  }
  qh_freeqhull(&qh, !qh_ALL);
  int long_blocks = 0, long_bytes = 0;
  qh_memfreeshort(&qh, &long_blocks, &long_bytes);
  std::fclose(silence);
  return answer;
}

}  // namespace regrasp::test
