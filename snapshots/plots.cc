#include "snapshots/plots.h"

#include <stdexcept>

#include "snapshots/refused.h"

namespace regrasp {

namespace {

void DrawByName(std::string_view name, const PlotInput& input, const std::string& path) {
#define REGRASP_ROW(word, Name, of) \
  if (name == #word) return Draw##Name(input, path);
  REGRASP_PLOTS(REGRASP_ROW)
#undef REGRASP_ROW
  throw std::runtime_error(path + ": no picture is called " + std::string(name));
}

}  // namespace

void DrawPlot(std::string_view name, const PlotInput& input, const std::string& path) {
  try {
    DrawByName(name, input, path);
  } catch (const PictureSizeRefused& e) {
    const PlotOptions& options = input.options;
    if (options.width_mm <= 0 || options.dpi <= 0) throw;
    throw PictureSizeRefused(path, e.width_px, e.height_px, {options.width_mm, options.dpi});
  }
}

}  // namespace regrasp
