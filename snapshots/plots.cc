#include "snapshots/plots.h"

#include <stdexcept>

namespace regrasp {

void DrawPlot(std::string_view name, const PlotInput& input, const std::string& path) {
#define REGRASP_ROW(word, Name, of) \
  if (name == #word) return Draw##Name(input, path);
  REGRASP_PLOTS(REGRASP_ROW)
#undef REGRASP_ROW
  throw std::runtime_error(path + ": no picture is called " + std::string(name));
}

}  // namespace regrasp
