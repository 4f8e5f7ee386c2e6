#pragma once

/// Animated GIF (version 89a, W3C): 256 colours of its own for each picture, LZW.

#include <cstdint>
#include <fstream>
#include <span>
#include <string>

namespace regrasp::run {

class Gif {
 public:
  /// `delay_s`: how long each picture stands; GIF counts in 0.01 s. Throws std::runtime_error.
  Gif(const std::string& path, int width, int height, double delay_s);
  /// A picture of width x height pixels, blue, green, red.
  void Add(std::span<const std::uint8_t> bgr);
  /// Throws std::runtime_error when something could not be written.
  void Finish();

 private:
  void Number(int value);  ///< 16 bits

  std::string path_;
  std::ofstream out_;
  int width_, height_;
  double delay_, owed_ = 0;  ///< [0.01 s]
};

}  // namespace regrasp::run
