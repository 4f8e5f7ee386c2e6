#pragma once

/// Why there is no picture, whatever its file.

#include <stdexcept>
#include <string>

namespace regrasp {

/// There is nothing to draw, or not in this size. `what()` begins with the path, as of all errors
/// of pictures; who asked by another name takes `cause()`.
class PictureRefused : public std::runtime_error {
 public:
  PictureRefused(const std::string& path, const std::string& cause)
      : std::runtime_error(path + ": " + cause), cause_(cause) {}
  const std::string& cause() const { return cause_; }

 private:
  std::string cause_;
};

inline constexpr int kMostPixels = 8000;  ///< of a picture's width, and of its height

/// Too few pixels, or too many.
class PictureSizeRefused : public PictureRefused {
 public:
  struct Printed {
    double width_mm = 0, dpi = 0;  ///< 0: the pixels do not follow from them
  };
  PictureSizeRefused(const std::string& path, int width, int height, const Printed& printed);

  int width_px, height_px;
  double nearest_dpi = 0;  ///< that is allowed, where the pixels follow from dpi
};

/// Throws PictureSizeRefused unless a picture may have so many pixels.
void CheckPictureSize(const std::string& path, int width_px, int height_px);

}  // namespace regrasp
