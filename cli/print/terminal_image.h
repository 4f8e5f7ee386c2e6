#pragma once

/// A picture as text for a terminal: four ways, from the best that a terminal may know to the one
/// that every terminal knows. No terminal and no socket here.

#include <cstdint>
#include <string>
#include <vector>

namespace regrasp::cli {

/// 8-bit RGB, row by row from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  const std::uint8_t* at(int x, int y) const {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x))];
  }
};

/// Decodes a PNG file, on white where it is transparent. Throws CliError(kIo) with file and cause.
Image DecodePng(const std::string& png, const std::string& name);

/// The picture in another size; every new pixel is the mean of those it covers. Sizes are positive.
Image Resize(const Image& image, int width, int height);

/// The largest size of the picture's shape inside width x height, never larger than the picture.
struct Size {
  int width, height;
};
Size Fit(const Image& image, int width, int height);

/// Kitty's graphics protocol: the PNG file itself, in chunks of 4096 letters, `columns` cells wide
/// (0: in its own size). https://sw.kovidgoyal.net/kitty/graphics-protocol/
std::string Kitty(const std::string& png, int columns);
/// Sixel, in at most 255 colours.
std::string Sixel(const Image& image);
/// Two pixels a cell, one above the other, as ▀ in two colours; `true_color` or the 256-colour
/// cube.
std::string HalfBlocks(const Image& image, bool true_color);
/// Eight pixels a cell as Braille dots, without colour: what is darker than the background or
/// brighter, by a good part of the range. The background is the commonest brightness.
std::string Dots(const Image& image);

std::string Base64(const std::string& bytes);

}  // namespace regrasp::cli
