#include "snapshots/refused.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr int kLeastWidth = 400, kLeastHeight = 300, kMost = kMostPixels;  // [px]
constexpr double kLeastDpi = 50, kMostDpi = 1200;  // as the wire's table has them

/// A pixel or two on the safe side of what rounding makes of the sizes.
double LeastDpi(int width_px, int height_px, double dpi) {
  const double share =
      std::max(1.0 * kLeastWidth / (width_px - 1), 1.0 * kLeastHeight / (height_px - 2));
  return std::max(kLeastDpi, std::ceil(dpi * share));
}
double MostDpi(int width_px, int height_px, double dpi) {
  const double share = std::min(1.0 * kMost / (width_px + 1), 1.0 * kMost / (height_px + 2));
  return std::min(kMostDpi, std::floor(dpi * share));
}

std::string Cause(int width_px, int height_px, const PictureSizeRefused::Printed& printed) {
  const std::string size =
      fmt::format("a picture of {} x {} pixels; allowed are {} x {} to {} x {}", width_px,
                  height_px, kLeastWidth, kLeastHeight, kMost, kMost);
  if (printed.dpi == 0) return size;
  return fmt::format("{:g} mm at {:g} dpi are {}, so {:g} to {:g} dpi", printed.width_mm,
                     printed.dpi, size, LeastDpi(width_px, height_px, printed.dpi),
                     MostDpi(width_px, height_px, printed.dpi));
}

}  // namespace

PictureSizeRefused::PictureSizeRefused(const std::string& path, int width, int height,
                                       const Printed& printed)
    : PictureRefused(path, Cause(width, height, printed)), width_px(width), height_px(height) {
  if (printed.dpi == 0) return;
  const double least = LeastDpi(width, height, printed.dpi);
  nearest_dpi = printed.dpi < least ? least : MostDpi(width, height, printed.dpi);
}

void CheckPictureSize(const std::string& path, int width_px, int height_px) {
  if (width_px < kLeastWidth || width_px > kMost || height_px < kLeastHeight || height_px > kMost)
    throw PictureSizeRefused(path, width_px, height_px, {});
}

}  // namespace regrasp
