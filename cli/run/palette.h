#pragma once

/// The 256 colours that stand for a picture best, and the picture in these colours.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace regrasp::run {

/// Blue, green, red.
using Bgr = std::array<std::uint8_t, 3>;

/// At most 256 colours of `bgr` (pixels of 3 bytes): boxes of its colours are divided where their
/// squared error is largest, as in [Wu 1991], and each is represented by its mean.
std::vector<Bgr> PaletteOf(std::span<const std::uint8_t> bgr);

/// An index of `palette` for each pixel of rows of `width`; what a pixel is off is passed on to its
/// neighbours [Floyd, Steinberg 1976], so that shades do not become bands.
std::vector<std::uint8_t> Dithered(std::span<const std::uint8_t> bgr, int width,
                                   std::span<const Bgr> palette);

}  // namespace regrasp::run
