#include "bench/claims/parallel.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "bench/children.h"

namespace regrasp::claims {

std::vector<Row> Parallel(int n, int jobs, const std::function<Row(int)>& trial) {
  std::vector<Row> rows(n);
  std::vector<int> pipes;
  for (int w = 0; w < jobs; ++w) {
    int fd[2];
    if (pipe(fd) != 0) std::exit(74);
    if (fork() == 0) {
      close(fd[0]);
      FILE* out = fdopen(fd[1], "w");
      for (int k = w; k < n; k += jobs) {
        const Row row = trial(k);
        std::fprintf(out, "%d", k);
        for (double v : row) std::fprintf(out, " %.17g", v);
        std::fprintf(out, "\n");
        std::fflush(out);
      }
      std::fclose(out);
      _exit(0);
    }
    close(fd[1]);
    pipes.push_back(fd[0]);
  }
  for (int fd : pipes) {
    FILE* in = fdopen(fd, "r");
    char line[4096];
    while (std::fgets(line, sizeof(line), in)) {
      char* p = line;
      const int k = static_cast<int>(std::strtol(p, &p, 10));
      for (char* end = p;; p = end) {
        const double v = std::strtod(p, &end);
        if (end == p) break;
        rows[k].push_back(v);
      }
    }
    std::fclose(in);
  }
  WaitForChildren();
  return rows;
}

}  // namespace regrasp::claims
