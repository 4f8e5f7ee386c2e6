#include "cli/run/palette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace regrasp::run {
namespace {

constexpr std::size_t kMostColours = 256;
constexpr int kBits = 6;  // of a channel: colours that share them are one

/// Of 18 bits.
std::size_t CellOf(int b, int g, int r) {
  constexpr int kDrop = 8 - kBits;
  return static_cast<std::size_t>((r >> kDrop) << 2 * kBits | (g >> kDrop) << kBits | b >> kDrop);
}
constexpr std::size_t kCells = std::size_t{1} << 3 * kBits;

struct Shade {
  std::array<double, 3> mean{};
  double pixels = 0;
};

/// Some of the shades, and what it would gain to divide them.
struct Box {
  std::span<Shade> shades;
  std::array<double, 3> mean{};
  int axis = 0;      ///< along which they differ most
  double error = 0;  ///< sum of squares along it

  explicit Box(std::span<Shade> of) : shades(of) {
    double pixels = 0;
    std::array<double, 3> sum{}, squares{};
    for (const Shade& shade : shades) {
      pixels += shade.pixels;
      for (std::size_t k = 0; k < 3; ++k) sum[k] += shade.pixels * shade.mean[k];
    }
    for (std::size_t k = 0; k < 3; ++k) mean[k] = sum[k] / pixels;
    for (const Shade& shade : shades)
      for (std::size_t k = 0; k < 3; ++k)
        squares[k] += shade.pixels * (shade.mean[k] - mean[k]) * (shade.mean[k] - mean[k]);
    axis = static_cast<int>(std::ranges::max_element(squares) - squares.begin());
    error = shades.size() > 1 ? squares[static_cast<std::size_t>(axis)] : 0;
  }
};

std::vector<Shade> ShadesOf(std::span<const std::uint8_t> bgr) {
  struct Sum {
    std::array<std::uint32_t, 3> of{};
    std::uint32_t pixels = 0;
  };
  std::vector<Sum> sums(kCells);
  for (std::size_t i = 0; i + 2 < bgr.size(); i += 3) {
    Sum& sum = sums[CellOf(bgr[i], bgr[i + 1], bgr[i + 2])];
    for (std::size_t k = 0; k < 3; ++k) sum.of[k] += bgr[i + k];
    ++sum.pixels;
  }
  std::vector<Shade> shades;
  for (const Sum& sum : sums) {
    if (sum.pixels == 0) continue;
    Shade& shade = shades.emplace_back();
    shade.pixels = sum.pixels;
    for (std::size_t k = 0; k < 3; ++k) shade.mean[k] = sum.of[k] / shade.pixels;
  }
  return shades;
}

/// The index of the colour next to a cell's.
std::uint8_t Nearest(std::size_t cell, std::span<const Bgr> palette) {
  std::array<int, 3> colour{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int top = static_cast<int>(cell >> k * kBits) & ((1 << kBits) - 1);
    colour[k] = top << (8 - kBits) | top >> (2 * kBits - 8);
  }
  int best = std::numeric_limits<int>::max();
  std::size_t found = 0;
  for (std::size_t i = 0; i < palette.size(); ++i) {
    int distance = 0;
    for (std::size_t k = 0; k < 3; ++k)
      distance += (colour[k] - palette[i][k]) * (colour[k] - palette[i][k]);
    if (distance < best) best = distance, found = i;
  }
  return static_cast<std::uint8_t>(found);
}

}  // namespace

std::vector<Bgr> PaletteOf(std::span<const std::uint8_t> bgr) {
  std::vector<Shade> shades = ShadesOf(bgr);
  std::vector<Box> boxes;
  if (!shades.empty()) boxes.emplace_back(shades);
  while (!boxes.empty() && boxes.size() < kMostColours) {
    const auto worst = std::ranges::max_element(boxes, {}, &Box::error);
    if (worst->error <= 0) break;
    const Box box = *worst;
    const auto axis = static_cast<std::size_t>(box.axis);
    const auto upper =
        std::partition(box.shades.begin(), box.shades.end(),
                       [&](const Shade& shade) { return shade.mean[axis] <= box.mean[axis]; });
    const auto lower_count = static_cast<std::size_t>(upper - box.shades.begin());
    // Where rounding leaves all on one side there is nothing to divide.
    if (lower_count == 0 || lower_count == box.shades.size()) {
      worst->error = 0;
      continue;
    }
    *worst = Box(box.shades.first(lower_count));
    boxes.emplace_back(box.shades.subspan(lower_count));
  }
  std::vector<Bgr> palette;
  for (const Box& box : boxes) {
    Bgr& colour = palette.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      colour[k] = static_cast<std::uint8_t>(std::lround(box.mean[k]));
  }
  return palette;
}

std::vector<std::uint8_t> Dithered(std::span<const std::uint8_t> bgr, int width,
                                   std::span<const Bgr> palette) {
  constexpr std::int16_t kUnknown = -1;
  std::vector<std::int16_t> nearest(kCells, kUnknown);
  const auto columns = static_cast<std::size_t>(width);
  // What is passed on to this row and the next one [1/16 of a level], with a column at either end.
  std::vector<std::array<int, 3>> here(columns + 2), below(columns + 2);
  std::vector<std::uint8_t> indices;
  indices.reserve(bgr.size() / 3);
  for (std::size_t row = 0; (row + 1) * columns * 3 <= bgr.size(); ++row) {
    std::ranges::fill(below, std::array<int, 3>{});
    for (std::size_t x = 0; x < columns; ++x) {
      const auto pixel = bgr.subspan((row * columns + x) * 3, 3);
      std::array<int, 3> wanted;
      for (std::size_t k = 0; k < 3; ++k)
        wanted[k] = std::clamp(pixel[k] + ((here[x + 1][k] + 8) >> 4), 0, 255);
      const std::size_t cell = CellOf(wanted[0], wanted[1], wanted[2]);
      if (nearest[cell] == kUnknown) nearest[cell] = Nearest(cell, palette);
      indices.push_back(static_cast<std::uint8_t>(nearest[cell]));
      const Bgr& taken = palette[indices.back()];
      for (std::size_t k = 0; k < 3; ++k) {
        const int error = wanted[k] - taken[k];
        here[x + 2][k] += 7 * error;
        below[x][k] += 3 * error;
        below[x + 1][k] += 5 * error;
        below[x + 2][k] += error;
      }
    }
    std::swap(here, below);
  }
  return indices;
}

}  // namespace regrasp::run
