#pragma once

/// What tests of pictures look at.

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "snapshots/canvas.h"
#include "snapshots/palette.h"

namespace regrasp {

/// The pixels of what has been drawn.
inline cv::Mat Picture(Canvas* canvas) {
  const std::string png = canvas->Bytes();
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// Pixels within 12 levels of a colour in every channel: anti-aliased rims are lighter and do not
/// count.
inline int Count(const cv::Mat& bgr, Colour colour, const cv::Rect& where) {
  int count = 0;
  for (int y = where.y; y < where.br().y; ++y)
    for (int x = where.x; x < where.br().x; ++x) {
      const auto& p = bgr.at<cv::Vec3b>(y, x);
      count += std::abs(p[0] - colour.b) <= 12 && std::abs(p[1] - colour.g) <= 12 &&
               std::abs(p[2] - colour.r) <= 12;
    }
  return count;
}

}  // namespace regrasp
